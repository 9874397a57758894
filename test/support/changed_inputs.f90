!> Which parts of what tasks read differ between two studies: the products of the stages, which are all that a task has at hand
!> beside its own keys (stages_t in gearsweep_study_case_task), and those keys.
module test_support_changed_inputs
  use gearsweep_gear_gear, only: gear_t
  use gearsweep_base_kinds, only: dp
  use gearsweep_study_run_inputs, only: elements_inputs_t, motion_inputs_t
  use gearsweep_gear_pair, only: pair_t
  use gearsweep_base_piecewise, only: piecewise_t
  use gearsweep_study_run_study, only: study_t
  implicit none
  private
  public :: parts_apart, same_products

  !> Every component: numbers with all their digits, as in gearsweep_study_run_inputs.
  character(*), parameter :: every = '(*(g0, 1x))'

contains

  !> The parts of which the second study has another value, by more than rounding, as ` keys pair:3 pair:7 amount`: where a part
  !> holds many numbers, which of them. Empty where all are the same. Both studies have the same tasks. Not `fine`: the gears are
  !> one part each, and all that makes the path of contact is one.
  function parts_apart(before, after, fine) result(parts)
    type(study_t), intent(in) :: before, after
    logical, intent(in) :: fine
    character(:), allocatable :: parts
    integer :: i

    parts = ''
    do i = 1, size(before%tasks)
      if (after%tasks(i)%is_requested) call add('keys', before%tasks(i)%key_text /= after%tasks(i)%key_text)
    end do
    call add('gear', before%gear /= after%gear)
    if (allocated(before%pair)) then
      if (fine) call add_words('pair', words_of_pair(before%pair), words_of_pair(after%pair))
      if (.not. fine) call add_pair(before%pair, after%pair)
    end if
    call add_words('material', words_of_material(before), words_of_material(after))
    call add_words('iso', words_of_blank(before), words_of_blank(after))
    call add_words('section', words_of_section(before), words_of_section(after))
    call add_words('load', words([before%base_pitch, before%load, before%mass, before%hub_mass]), &
                   words([after%base_pitch, after%load, after%mass, after%hub_mass]))
    call add_words('elements', words_of_elements(before), words_of_elements(after))
    call add_motion(before%motions_inputs%motion, after%motions_inputs%motion)
    call add('stiffness', .not. is_near(before%motions_inputs%stiffness, after%motions_inputs%stiffness))
    call add('profile_error', .not. is_near(before%motions_inputs%profile_error, after%motions_inputs%profile_error))
    call add('amount', words(before%amount) /= words(after%amount))
    call add('rpm', words(before%rpm) /= words(after%rpm))
    call add('direction', before%direction /= after%direction)
    call add_words('accuracy', words_of_accuracy(before), words_of_accuracy(after))

  contains

    subroutine add(name, differs)
      character(*), intent(in) :: name
      logical, intent(in) :: differs

      if (differs .and. index(parts//' ', ' '//name//' ') == 0) parts = parts//' '//name
    end subroutine add

    subroutine add_pair(a, b)
      type(pair_t), intent(in) :: a, b

      call add('pinion', differ(words_of_pair(only_gear(a, 1)), words_of_pair(only_gear(b, 1))))
      call add('gear', differ(words_of_pair(only_gear(a, 2)), words_of_pair(only_gear(b, 2))))
      call add('path', differ(words_of_pair(without_gears(a)), words_of_pair(without_gears(b))))
    end subroutine add_pair

    subroutine add_motion(a, b)
      type(motion_inputs_t), intent(in) :: a, b

      if (fine) then
        call add_words('motion', words_of_motion(a), words_of_motion(b))
      else
        call add('path', differ(words_of_motion(a), words_of_motion(with_path(a, b))))
        call add_words('motion', words_of_motion(with_path(a, b)), words_of_motion(b))
      end if
    end subroutine add_motion

    subroutine add_words(name, a, b)
      character(*), intent(in) :: name, a, b

      parts = parts//places_apart(name, a, b)
    end subroutine add_words
  end function parts_apart

  !> Are the products of the stages the same to the last bit? Both studies are of the same case.
  logical function same_products(a, b) result(same)
    type(study_t), intent(in) :: a, b

    same = allocated(a%mesh) .eqv. allocated(b%mesh)
    same = same .and. words_of_motion(a%motions_inputs%motion) == words_of_motion(b%motions_inputs%motion)
    same = same .and. words_of_curve(a%motions_inputs%stiffness) == words_of_curve(b%motions_inputs%stiffness)
    same = same .and. words_of_curve(a%motions_inputs%profile_error) == words_of_curve(b%motions_inputs%profile_error)
    same = same .and. words_of_elements(a) == words_of_elements(b)
  end function same_products

  logical function differ(a, b)
    character(*), intent(in) :: a, b

    differ = places_apart('', a, b) /= ''
  end function differ

  !> The pair with nothing but one of its gears.
  type(pair_t) function only_gear(pair, gear)
    type(pair_t), intent(in) :: pair
    integer, intent(in) :: gear

    only_gear%gear(gear) = pair%gear(gear)
  end function only_gear

  type(pair_t) function without_gears(pair)
    type(pair_t), intent(in) :: pair

    without_gears = pair
    without_gears%gear = gear_t()
  end function without_gears

  !> The motion `a`, but over the path of contact of `b`.
  type(motion_inputs_t) function with_path(a, b)
    type(motion_inputs_t), intent(in) :: a, b

    with_path = a
    with_path%relief%base_pitch = b%relief%base_pitch
    with_path%relief%contact_ratio = b%relief%contact_ratio
    with_path%relief%pitch_point = b%relief%pitch_point
    with_path%reach = b%reach
    with_path%arm_change = b%arm_change
  end function with_path

  ! --- the parts as words, blanks between them ---------------------------------------------------

  function words(list)
    real(dp), intent(in) :: list(:)
    character(26*size(list)) :: words

    write (words, every) list
  end function words

  function words_of_pair(pair) result(words)
    type(pair_t), intent(in) :: pair
    character(storage_size(pair)) :: words

    write (words, every) pair
  end function words_of_pair

  function words_of_material(study) result(words)
    type(study_t), intent(in) :: study
    character(storage_size(study%material)*2) :: words

    write (words, every) study%material
  end function words_of_material

  function words_of_blank(study) result(words)
    type(study_t), intent(in) :: study
    character(storage_size(study%iso)) :: words

    write (words, every) study%iso
  end function words_of_blank

  !> The section's options, and the blank in three dimensions: gear and material are parts of their own.
  function words_of_section(study) result(words)
    type(study_t), intent(in) :: study
    character(storage_size(study%body_inputs)) :: words

    write (words, every) study%body_inputs%options, study%solid_inputs%web, study%solid_inputs%rim
  end function words_of_section

  function words_of_elements(study) result(words)
    type(study_t), intent(in) :: study
    type(elements_inputs_t) :: inputs
    character(storage_size(inputs)) :: words

    words = ''
    if (.not. allocated(study%elements_inputs)) return
    inputs = study%elements_inputs
    inputs%pair = pair_t()
    write (words, every) inputs
  end function words_of_elements

  function words_of_motion(motion) result(words)
    type(motion_inputs_t), intent(in) :: motion
    type(motion_inputs_t) :: inputs
    character(storage_size(motion)) :: words

    inputs = motion
    inputs%relief%pair = pair_t()
    write (words, every) inputs
  end function words_of_motion

  function words_of_accuracy(study) result(words)
    type(study_t), intent(in) :: study
    character(storage_size(study%accuracy)) :: words

    write (words, every) study%accuracy%step_choice_t, study%accuracy%steady%steady_choice_t
  end function words_of_accuracy

  function words_of_curve(curve) result(text)
    type(piecewise_t), intent(in) :: curve
    character(:), allocatable :: text

    text = ''
    if (allocated(curve%breaks)) text = words([curve%breaks, [curve%coef]])
  end function words_of_curve

  !> The same curve but for rounding?
  logical function is_near(a, b)
    type(piecewise_t), intent(in) :: a, b

    is_near = allocated(a%breaks) .eqv. allocated(b%breaks)
    if (.not. (is_near .and. allocated(a%breaks))) return
    is_near = size(a%breaks) == size(b%breaks) .and. size(a%coef) == size(b%coef)
    if (is_near) is_near = all_near(a%breaks, b%breaks) .and. all_near([a%coef], [b%coef])
  end function is_near

  logical function all_near(a, b)
    real(dp), intent(in) :: a(:), b(:)

    all_near = all(abs(a - b) <= 1e-9_dp*maxval(abs(a)))
  end function all_near

  !> Which words of two lists are another word, or a number that differs by more than 1e-9 of it: ` name:2 name:5`.
  function places_apart(name, a, b) result(places)
    character(*), intent(in) :: name, a, b
    character(:), allocatable :: places
    character(12) :: place
    integer :: at, to, until, end, n

    places = ''
    at = 1
    to = 1
    n = 0
    do
      until = next_blank(a, at)
      end = next_blank(b, to)
      if (at > len(a) .and. to > len(b)) exit
      n = n + 1
      if (.not. is_same(a(at:until), b(to:end))) then
        write (place, '(i0)') n
        places = places//' '//name//':'//trim(place)
      end if
      at = until + 1
      to = end + 1
    end do
  end function places_apart

  !> Moves `at` to the next word; where that ends.
  integer function next_blank(text, at) result(until)
    character(*), intent(in) :: text
    integer, intent(inout) :: at
    integer :: skipped

    until = len(text)
    if (at > len(text)) return
    skipped = verify(text(at:), ' ') - 1
    if (skipped < 0) skipped = len(text) - at + 1
    at = at + skipped
    if (at > len(text)) return
    until = at + scan(text(at:)//' ', ' ') - 2
  end function next_blank

  logical function is_same(a, b)
    character(*), intent(in) :: a, b
    real(dp) :: values(2)
    integer :: info

    is_same = a == b
    if (is_same) return
    read (a, *, iostat=info) values(1)
    if (info == 0) read (b, *, iostat=info) values(2)
    if (info == 0) is_same = abs(values(1) - values(2)) <= 1e-9_dp*maxval(abs(values))
  end function is_same
end module test_support_changed_inputs
