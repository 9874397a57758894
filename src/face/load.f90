!> Load distribution over the face width and the path of contact of a pair of spur gears.
!>
!> Each pair of teeth in contact has one line over the face. Its compliance is that of gearsweep_face_law for both gears, and
!> neighbouring lines share the compliance of their bodies; gearsweep_face_contact finds which slices touch, and their loads. The
!> rotation of complete gears about their bores is in series with all lines.
module gearsweep_face_load
  use gearsweep_base, only: code_input, dp, error_t, fail, pi, piecewise_t, str
  use gearsweep_gear, only: pair_t
  use gearsweep_elastic, only: check_contact, contact_half_width, fe_options_t, material_t, plane_compliance, plane_tooth_t, teeth_t
  use gearsweep_face_contact, only: flat_t, solve_contact
  use gearsweep_face_law, only: even_half_space, face_law_t, graded_slices, make_face_law, root_spread, tooth_remainder
  use gearsweep_face_alignment, only: alignment_t, check_alignment
  use gearsweep_face_shaft, only: check_shaft, shaft_t
  implicit none
  private
  public :: face_mesh_t, face_load_t, make_face_mesh, find_face_load

  !> A pair of spur gears, as its load distribution depends on it; of gears with a geometry `make_face_mesh` fills it in.
  type :: face_mesh_t
    type(pair_t) :: pair                         !< path of contact, radii of curvature, module
    type(material_t) :: material(2)
    real(dp) :: width = 0                        !< common face width b, m
    type(plane_tooth_t) :: tooth(2)              !< plane compliance of pinion and gear, its path coordinate from A to E
    type(piecewise_t) :: profile_error           !< gap of a pair over the path, m; not allocated: 0
  contains
    procedure :: half_width
  end type face_mesh_t

  !> Load distribution over a mesh period. Phases include both ends of each interval with the same number of pairs, so that values
  !> jump between two rows of one phase. `per` is the load over the face width, F/b.
  type :: face_load_t
    real(dp), allocatable :: bounds(:)           !< of the slices, from one end of the face, m; (0:slices)
    real(dp), allocatable :: gap(:)              !< of the unloaded flanks, without profile error, m; (slice)
    real(dp), allocatable :: phase(:)            !< mesh phase, 0 to 1; (row)
    real(dp), allocatable :: share(:)            !< of the period that a row stands for; (row)
    integer, allocatable :: pairs(:)             !< lines of contact; (row)
    real(dp), allocatable :: line_load(:, :, :)  !< N/m; (slice, pair, row)
    real(dp), allocatable :: pressure(:, :, :)   !< Hertz's, Pa; (slice, pair, row)
    real(dp), allocatable :: error(:)            !< static transmission error, m; (row)
    real(dp), allocatable :: stiffness(:)        !< tangent stiffness of the mesh, N/m; (row)
    real(dp), allocatable :: factor(:)           !< largest load over one module of the face over F/b; (row)
    !> K_H beta: of the mean over the period of the load of all pairs, largest at any phase, in the middle of contact of the
    !> fewest pairs.
    real(dp) :: mean_factor = 0, worst_factor = 0, single_factor = 0
    real(dp) :: worst_phase = 0
    !> K_F beta: largest root stress along the face over that of an even load, at the outer points of contact of the fewest
    !> pairs; the larger of pinion's and gear's.
    real(dp) :: root_factor = 0
    real(dp) :: edge_load = 0                    !< mean over the period of the load on the outermost module, larger end, over F/b
    real(dp) :: in_contact = 0                   !< fraction of the face that carries in the middle of contact of the fewest pairs
    real(dp) :: largest_pressure = 0             !< Pa
  contains
    procedure :: middle
    procedure :: load_at
  end type face_load_t

  real(dp), parameter :: least_width = 3         !< modules; the end faces act within some three modules
  real(dp), parameter :: slice_over_contact = 4  !< smallest width of a slice over the mean half width of the contact

contains

  !> Computes what the load distribution of a `pair` depends on, by plane finite elements.
  !>
  !> `material` and `options` as of `fe_stiffness`, plane strain; `profile_error` (m over s): tip relief; `teeth`: stored teeth.
  subroutine make_face_mesh(pair, material, options, mesh, error, profile_error, teeth)
    type(pair_t), intent(in) :: pair
    type(material_t), intent(in) :: material(2)
    type(fe_options_t), intent(in) :: options
    type(face_mesh_t), intent(out) :: mesh
    type(error_t), allocatable, intent(out) :: error
    type(piecewise_t), intent(in), optional :: profile_error
    type(teeth_t), intent(inout), optional :: teeth

    mesh%pair = pair
    mesh%material = material
    mesh%width = minval(pair%gear%spec%face_width)
    if (present(profile_error)) mesh%profile_error = profile_error
    call plane_compliance(pair, material, options, mesh%tooth, error, teeth)
  end subroutine make_face_mesh

  !> Half width (m) of the contact at path coordinate `s` under a `line_load` (N/m).
  elemental real(dp) function half_width(mesh, s, line_load)
    class(face_mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: s, line_load

    half_width = contact_half_width(mesh%material(1), mesh%material(2), .true., line_load, mesh%pair%curvature(1, s), &
                                    mesh%pair%curvature(2, s))
  end function half_width

  !> Finds the load of each pair over the face width at phases of a mesh period, under a `load` (N on the line of action).
  !>
  !> `error`: a face narrower than three modules, faces that cannot meet so (`check_alignment`), a contact wider than a module.
  subroutine find_face_load(mesh, alignment, load, product, error, slices, shaft)
    type(face_mesh_t), intent(in) :: mesh
    type(alignment_t), intent(in) :: alignment   !< misalignment and leads
    real(dp), intent(in) :: load
    type(face_load_t), intent(out) :: product
    type(error_t), allocatable, intent(out) :: error
    integer, intent(in), optional :: slices      !< about this number over the face; absent or 0: 0.35 to 1 module wide
    type(shaft_t), intent(in), optional :: shaft           !< of the pinion, which deflects; absent: rigid
    type(face_law_t) :: law(2)
    real(dp) :: half_width
    integer :: i, wanted

    wanted = 0
    if (present(slices)) wanted = slices
    associate (module => mesh%pair%gear(1)%spec%module, path => mesh%pair%contact_ratio*[0.0_dp, 0.5_dp, 1.0_dp])
      if (.not. load > 0) call fail(error, code_input, 'load (N) = '//str(load)//': must be above 0')
      if (.not. mesh%width >= least_width*module) call fail(error, code_input, 'face width (mm) = '//str(1000*mesh%width)// &
        ': must be at least '//str(least_width)//' modules for a load distribution over it')
      call check_alignment(alignment, mesh%width, error)
      if (present(shaft)) call check_shaft(shaft, mesh%width, error)
      if (allocated(error)) return
      half_width = maxval(mesh%half_width(path, load/mesh%width))
      call check_contact(half_width, module, load/mesh%width, error)
      if (allocated(error)) return
      associate (bounds => graded_slices(mesh%width, module, [alignment%lead%end_relief_length], slice_over_contact*half_width, &
                                         wanted))
        allocate (product%bounds(0:size(bounds) - 1), source=bounds)
      end associate
    end associate
    product%gap = alignment%gap(mesh%width, product%middle())
    if (present(shaft)) product%gap = product%gap + shaft%gap(load, mesh%width, product%middle())
    call find_law(mesh, product%bounds, law, error)
    if (allocated(error)) return
    call place_phases(mesh%pair%contact_ratio, size(product%gap), product)
    do i = 1, size(product%phase)
      call solve_phase(mesh, law, load, i, product, error)
      if (allocated(error)) return
    end do
    call summarise(mesh, load, product)
  end subroutine find_face_load

  !> Middle of each slice, m.
  pure function middle(product)
    class(face_load_t), intent(in) :: product
    real(dp) :: middle(ubound(product%bounds, 1))

    associate (n => size(middle))
      middle = (product%bounds(:n - 1) + product%bounds(1:))/2
    end associate
  end function middle

  !> Line load of all pairs at a row, N/m; (slice).
  pure function load_at(product, row)
    class(face_load_t), intent(in) :: product
    integer, intent(in) :: row
    real(dp) :: load_at(size(product%gap))

    load_at = sum(product%line_load(:, :product%pairs(row), row), 2)
  end function load_at

  !> Compliance that the tooth of a gear at path coordinate `s` shares with its neighbours, m2/N: the mean of both, so that pinion
  !> and gear may be exchanged.
  elemental real(dp) function shared_at(tooth, s)
    type(plane_tooth_t), intent(in) :: tooth
    real(dp), intent(in) :: s

    associate (breaks => tooth%shared%breaks)
      shared_at = (tooth%shared%value(min(s, breaks(size(breaks)))) + tooth%shared%value(max(s - 1, breaks(1))))/2
    end associate
  end function shared_at

  !> Computes the law of both gears.
  pure subroutine find_law(mesh, bounds, law, error)
    type(face_mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: bounds(0:)
    type(face_law_t), intent(out) :: law(2)
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: shared, remainder
    integer :: i

    do i = 1, 2
      associate (tooth => mesh%tooth(i), half => mesh%pair%contact_ratio/2)
        shared = tooth%modulus*shared_at(tooth, half)
        remainder = tooth_remainder(tooth%modulus*tooth%compliance%value(half), shared)
      end associate
      if (.not. remainder > 0) then
        call fail(error, code_input, 'plane compliance times E/(1 - nu**2) = '// &
                  str(remainder + shared + even_half_space)//': must be above that of a half space and of the body, '// &
                  str(even_half_space + shared))
        return
      end if
      call make_face_law(bounds/mesh%pair%gear(1)%spec%module, remainder, shared, law(i))
    end do
  end subroutine find_law

  !> Chooses the phases: in equal steps over each interval with the same number of pairs, an even number of steps; the last
  !> interval has the fewest pairs. Shares are those of the trapezoidal rule.
  pure subroutine place_phases(contact_ratio, slices, product)
    real(dp), intent(in) :: contact_ratio
    integer, intent(in) :: slices
    type(face_load_t), intent(inout) :: product
    integer, parameter :: phases = 32            ! about this number
    real(dp) :: ends(3)
    integer :: i, k, n

    ends = [0.0_dp, contact_ratio - aint(contact_ratio), 1.0_dp]
    allocate (product%phase(0), product%share(0), product%pairs(0))
    do i = 1, 2
      associate (length => ends(i + 1) - ends(i))
        if (.not. length > 0) cycle
        n = 2*max(1, nint(phases*length/2))
        product%phase = [product%phase, [(ends(i) + length*k/n, k=0, n)]]
        product%share = [product%share, [(length/n*merge(0.5_dp, 1.0_dp, k == 0 .or. k == n), k=0, n)]]
        product%pairs = [product%pairs, [(int(contact_ratio) + 2 - i, k=0, n)]]
      end associate
    end do
    n = size(product%phase)
    allocate (product%line_load(slices, maxval(product%pairs), n), source=0.0_dp)
    allocate (product%pressure, source=product%line_load)
    allocate (product%error(n), product%stiffness(n), product%factor(n))
  end subroutine place_phases

  !> Finds the loads at the phase of `row`.
  subroutine solve_phase(mesh, law, load, row, product, error)
    type(face_mesh_t), intent(in) :: mesh
    type(face_law_t), intent(in) :: law(2)
    real(dp), intent(in) :: load
    integer, intent(in) :: row
    type(face_load_t), intent(inout) :: product
    type(error_t), allocatable, intent(inout) :: error
    real(dp), dimension(size(product%gap)*product%pairs(row)) :: width, gap, line_load, square
    real(dp) :: compliance(size(width), size(width)), s(product%pairs(row)), turn
    type(flat_t) :: flat
    integer :: own(size(product%gap)), i, j, k, n, pairs

    n = size(product%gap)
    pairs = product%pairs(row)
    s = min(product%phase(row) + [(j, j=0, pairs - 1)], mesh%pair%contact_ratio)
    do j = 1, pairs
      own = n*(j - 1) + [(i, i=1, n)]
      width(own) = product%bounds(1:) - product%bounds(:n - 1)
      gap(own) = product%gap
      if (allocated(mesh%profile_error%breaks)) gap(own) = product%gap + mesh%profile_error%value(s(j))
      square(own) = mesh%half_width(s(j), 1.0_dp)**2
      compliance(own, own) = of_line(s(j))
      do k = j + 1, pairs
        compliance(own, own + n*(k - j)) = between_lines(s(j), k - j)
        compliance(own + n*(k - j), own) = compliance(own, own + n*(k - j))
      end do
    end do
    associate (module => mesh%pair%gear(1)%spec%module)
      flat = flat_t(2/pi*sum(1/[mesh%tooth%modulus]), square/module**2)
      call solve_contact(module*compliance, width, gap, flat, load, product%error(row), line_load, product%stiffness(row), error)
    end associate
    if (allocated(error)) return
    turn = sum([mesh%tooth%turn])/mesh%width
    product%error(row) = product%error(row) + turn*load
    product%stiffness(row) = product%stiffness(row)/(1 + turn*product%stiffness(row))
    product%line_load(:, :pairs, row) = reshape(line_load, [n, pairs])
    where (line_load > 0) line_load = 2*sqrt(line_load/square)/pi
    product%pressure(:, :pairs, row) = reshape(line_load, [n, pairs])
    product%factor(row) = largest_mean(product%bounds, product%load_at(row), mesh%pair%gear(1)%spec%module)/(load/mesh%width)

  contains

    !> Compliance of both gears over the slices of the line at `s`, 1/Pa.
    pure function of_line(s)
      real(dp), intent(in) :: s
      real(dp) :: of_line(n, n), shared
      integer :: i

      of_line = 0
      do i = 1, 2
        associate (tooth => mesh%tooth(i))
          shared = tooth%modulus*shared_at(tooth, s)
          of_line = of_line + law(i)%of_tooth(tooth_remainder(tooth%modulus*tooth%compliance%value(s), shared), shared) &
                    /tooth%modulus
        end associate
      end do
    end function of_line

    !> Compliance that the line at `s` shares with the one `later` teeth after it, 1/Pa.
    pure function between_lines(s, later) result(shared)
      real(dp), intent(in) :: s
      integer, intent(in) :: later
      real(dp) :: shared(n, n)
      integer :: i

      shared = 0
      do i = 1, 2
        associate (tooth => mesh%tooth(i))
          shared = shared + (tooth%shared%value(s) - merge(tooth%decline, 0.0_dp, later > 1))*law(i)%body
        end associate
      end do
    end function between_lines
  end subroutine solve_phase

  !> Computes the factors of all phases.
  pure subroutine summarise(mesh, load, product)
    type(face_mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load
    type(face_load_t), intent(inout) :: product
    real(dp) :: mean(size(product%gap)), spread(size(product%gap), size(product%gap)), per, edge(2)
    integer :: i, first, last, single

    per = load/mesh%width
    mean = 0
    do i = 1, size(product%phase)
      mean = mean + product%share(i)*product%load_at(i)
    end do
    product%mean_factor = largest_mean(product%bounds, mean, mesh%pair%gear(1)%spec%module)/per
    i = maxloc(product%factor, 1)
    product%worst_factor = product%factor(i)
    product%worst_phase = product%phase(i)
    associate (b => product%bounds, m => mesh%pair%gear(1)%spec%module)
      edge = [load_between(b, mean, 0.0_dp, m), load_between(b, mean, mesh%width - m, mesh%width)]
      product%edge_load = maxval(edge)/(m*per)
    end associate
    ! The last interval, from B to D.
    last = size(product%phase)
    first = findloc(product%pairs, product%pairs(last), 1)
    single = (first + last)/2
    product%single_factor = product%factor(single)
    associate (n => size(product%gap))
      product%in_contact = sum(product%bounds(1:) - product%bounds(:n - 1), mask=product%load_at(single) > 0)/mesh%width
    end associate
    product%largest_pressure = maxval(product%pressure)
    spread = root_spread(product%bounds/mesh%pair%gear(1)%spec%module)
    product%root_factor = max(root_factor(product%line_load(:, product%pairs(last), last)), &
                              root_factor(product%line_load(:, 1, first)))

  contains

    !> Largest root stress under the loads of one line over that of their mean.
    pure real(dp) function root_factor(line_load) result(factor)
      real(dp), intent(in) :: line_load(:)

      factor = 1
      if (any(line_load > 0)) factor = maxval(matmul(spread, line_load)) &
                                       /(load_between(product%bounds, line_load, 0.0_dp, mesh%width)/mesh%width)
    end function root_factor
  end subroutine summarise

  !> Largest mean of a line load over a part of the face as long as the `window`. Between slices' bounds the mean is linear in
  !> the window's place, so that it is largest where an end of the window is on a bound.
  pure real(dp) function largest_mean(bounds, line_load, window) result(largest)
    real(dp), intent(in) :: bounds(0:), line_load(:), window
    integer :: i

    largest = 0
    associate (width => bounds(ubound(bounds, 1)))
      do i = 0, ubound(bounds, 1)
        if (bounds(i) + window <= width) largest = max(largest, load_between(bounds, line_load, bounds(i), bounds(i) + window))
        if (bounds(i) - window >= 0) largest = max(largest, load_between(bounds, line_load, bounds(i) - window, bounds(i)))
      end do
    end associate
    largest = largest/window
  end function largest_mean

  !> Load (N) of a line load on the part of the face between two places (m).
  pure real(dp) function load_between(bounds, line_load, from, to) result(force)
    real(dp), intent(in) :: bounds(0:), line_load(:), from, to
    integer :: n

    n = size(line_load)
    force = sum(line_load*max(0.0_dp, min(bounds(1:), to) - max(bounds(:n - 1), from)))
  end function load_between
end module gearsweep_face_load
