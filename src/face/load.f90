!> Load distribution over the face width and the path of contact of a pair of spur or helical gears.
!>
!> Each pair of teeth in contact has one line over the face, or over a part of it. The path coordinate falls along an oblique line:
!> contact of a pair begins at the end face z = 0, and ends at the other. The compliance of a line is that of gearsweep_face_law for
!> both gears, and neighbouring lines share the compliance of their bodies; gearsweep_face_contact finds which slices touch, and
!> their loads. The rotation of complete gears about their bores is in series with all lines. A line load is per length of the line;
!> on the transverse line of action it is the load over the face width along z.
module gearsweep_face_load
  use gearsweep_base, only: code_input, dp, error_t, fail, pi, piecewise_t, sorted, str
  use gearsweep_gear, only: pair_t
  use gearsweep_elastic, only: check_contact, contact_half_width, fe_options_t, material_t, plane_compliance, plane_tooth_t, teeth_t
  use gearsweep_face_contact, only: flat_t, solve_contact
  use gearsweep_face_law, only: even_half_space, face_law_t, graded_slices, line_law_t, make_face_law, make_oblique, mean_of, &
    root_spread, tooth_remainder
  use gearsweep_face_alignment, only: alignment_t, check_alignment
  use gearsweep_face_shaft, only: check_shaft, shaft_t
  implicit none
  private
  public :: face_mesh_t, face_load_t, make_face_mesh, find_face_load, find_pair_loads

  !> A pair of gears, as its load distribution depends on it; of gears with a geometry `make_face_mesh` fills it in.
  type :: face_mesh_t
    type(pair_t) :: pair                         !< path of contact, radii of curvature, module
    type(material_t) :: material(2)
    real(dp) :: width = 0                        !< common face width b, m
    type(plane_tooth_t) :: tooth(2)              !< plane compliance of pinion and gear, its path coordinate from A to E
    type(piecewise_t) :: profile_error           !< gap of a pair over the path, m; not allocated: 0
  contains
    procedure :: half_width
    procedure :: slant
    procedure :: at_plane
  end type face_mesh_t

  !> One line of contact at a phase, cut into slices: those of the face, but for the ends of a line inside the face.
  type :: line_t
    integer, allocatable :: list(:)              !< of the bounds of its slices in the law
    real(dp), allocatable :: bounds(:)           !< of its slices over the face, m; (0:slices)
    real(dp), allocatable :: s(:)                !< path coordinate in the middle of each slice
    real(dp) :: start = 0                        !< path coordinate at z = 0, which may be past the path
  contains
    procedure :: onto_face
  end type line_t

  !> Lines of contact at a phase as slices in contact; (slice of all lines).
  type :: lines_t
    type(line_t), allocatable :: line(:)         !< (pair)
    integer, allocatable :: first(:)             !< first slice of each line, and one after the last
    real(dp), allocatable :: width(:)            !< lengths along the lines, m
    real(dp), allocatable :: gap(:)              !< of the unloaded flanks with profile error, m
    real(dp), allocatable :: square(:)           !< square of Hertz's half width per line load, m3/N
    real(dp), allocatable :: compliance(:, :)    !< of both gears, in modules, 1/Pa
    type(flat_t) :: flat
  end type lines_t

  !> Loads of the pairs over their common deflection at the phases of a mesh period, for its motion.
  type, public :: pair_loads_t
    real(dp), allocatable :: phase(:)            !< mesh phase, 0 to 1; both ends of intervals with the same number of pairs; (row)
    integer, allocatable :: pairs(:)             !< lines of contact; (row)
    real(dp), allocatable :: deflection(:, :)    !< without the turning of complete gears about their bores, m; (load, row)
    real(dp), allocatable :: load(:, :, :)       !< N; (load, pair, row)
    real(dp), allocatable :: touching(:, :)      !< smallest gap of a pair's flanks, m; of no line at all: huge; (pair, row)
  end type pair_loads_t

  !> Load distribution over a mesh period. Phases include both ends of each interval with the same number of pairs, so that values
  !> jump between two rows of one phase. `per` is the load over the face width, F/b.
  type :: face_load_t
    real(dp), allocatable :: bounds(:)           !< of the slices, from one end of the face, m; (0:slices)
    real(dp), allocatable :: gap(:)              !< of the unloaded flanks, without profile error, m; (slice)
    real(dp), allocatable :: phase(:)            !< mesh phase, 0 to 1; (row)
    real(dp), allocatable :: share(:)            !< of the period that a row stands for; (row)
    integer, allocatable :: pairs(:)             !< lines of contact; (row)
    real(dp), allocatable :: path(:, :, :)       !< path coordinate in a slice's middle, also past the path; (slice, pair, row)
    real(dp), allocatable :: line_load(:, :, :)  !< N/m; (slice, pair, row)
    real(dp), allocatable :: pressure(:, :, :)   !< Hertz's, Pa; (slice, pair, row)
    real(dp), allocatable :: error(:)            !< static transmission error, m; (row)
    real(dp), allocatable :: deflection(:)       !< the same without the turning of complete gears about their bores, m; (row)
    real(dp), allocatable :: stiffness(:)        !< tangent stiffness of the mesh, N/m; (row)
    !> Load (N) and tangent stiffness (N/m) of each pair under `deflection`; (pair, row).
    real(dp), allocatable :: pair_load(:, :), pair_stiffness(:, :)
    real(dp), allocatable :: factor(:)           !< largest load over one module of the face over F/b; (row)
    real(dp), allocatable :: contact(:)          !< fraction of the length of all lines that carries; (row)
    !> K_H beta: of the mean over the period of the load of all pairs, and in the middle of contact of the fewest pairs. For helical
    !> gears the second equals the first, as their lines cover parts of the face that change with the phase.
    real(dp) :: mean_factor = 0, single_factor = 0
    !> K_F beta: largest root stress along the face over that of an even load, at the outer points of contact of the fewest
    !> pairs, the larger of pinion's and gear's; of helical gears under the load's mean over the period.
    real(dp) :: root_factor = 0
    real(dp) :: edge_load = 0                    !< mean over the period of the load on the outermost module, larger end, over F/b
    !> Fraction of the face that carries in the middle of contact of the fewest pairs; of helical gears the mean of `contact`.
    real(dp) :: in_contact = 0
  contains
    procedure :: middle
    procedure :: load_at
  end type face_load_t

  real(dp), parameter :: least_width = 3         !< modules; the end faces act within some three modules
  real(dp), parameter :: slice_over_contact = 4  !< smallest width of a slice over the mean half width of the contact
  real(dp), parameter :: most_helix = 30*pi/180  !< largest helix angle that the law is known for
  !> Smallest width of the slice at a line's end inside the face, over the smallest of the face: a narrower part belongs to the
  !> next slice.
  real(dp), parameter :: least_part = 0.7_dp

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

    half_width = contact_half_width(mesh%material(1), mesh%material(2), .true., line_load, mesh%pair%curvature(1, s)/mesh%slant(), &
                                    mesh%pair%curvature(2, s)/mesh%slant())
  end function half_width

  !> Cosine of the angle between lines of contact and axes, cos(beta_b).
  elemental real(dp) function slant(mesh)
    class(face_mesh_t), intent(in) :: mesh

    slant = cos(mesh%pair%gear(1)%base_helix())
  end function slant

  !> Computes c1 and c12 of a gear (times E/(1 - nu**2)) at path coordinates `s`.
  pure subroutine at_plane(mesh, gear, s, remainder, shared)
    class(face_mesh_t), intent(in) :: mesh
    integer, intent(in) :: gear
    real(dp), intent(in) :: s(:)
    real(dp), intent(out) :: remainder(:), shared(:)
    integer :: i

    associate (tooth => mesh%tooth(gear))
      shared = tooth%modulus*shared_at(tooth, s)
      remainder = tooth_remainder(tooth%modulus*[(tooth%compliance%value(s(i)), i=1, size(s))], shared)
    end associate
    call make_oblique(tan(mesh%pair%gear(1)%spec%helix_angle), remainder, shared)
  end subroutine at_plane

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
    type(lines_t) :: lines
    integer :: i

    call cut_face(mesh, alignment, load, load, product, law, error, slices, shaft)
    if (allocated(error)) return
    do i = 1, size(product%phase)
      call place_slices(mesh, law, alignment, load, load, i, product, lines, shaft)
      call solve_phase(mesh, lines, load, i, product, error)
      if (allocated(error)) return
    end do
    call summarise(mesh, load, product)
  end subroutine find_face_load

  !> Finds the load of each pair over the deflection: under each of several `loads` (N), ascending, at the phases of a mesh period.
  !> The shaft deflects as under the static `load` (N).
  !>
  !> `error`: as of `find_face_load`, for the largest load.
  subroutine find_pair_loads(mesh, alignment, load, loads, product, error, slices, shaft)
    type(face_mesh_t), intent(in) :: mesh
    type(alignment_t), intent(in) :: alignment   !< misalignment and leads
    real(dp), intent(in) :: load, loads(:)
    type(pair_loads_t), intent(out) :: product
    type(error_t), allocatable, intent(out) :: error
    integer, intent(in), optional :: slices      !< as of `find_face_load`
    type(shaft_t), intent(in), optional :: shaft
    type(face_load_t) :: face
    type(face_law_t) :: law(2)
    type(lines_t) :: lines
    real(dp), allocatable :: line_load(:), rate(:)
    integer :: i, j, k, most

    call cut_face(mesh, alignment, load, loads(size(loads)), face, law, error, slices, shaft)
    if (allocated(error)) return
    product%phase = face%phase
    product%pairs = face%pairs
    most = maxval(face%pairs)
    allocate (product%deflection(size(loads), size(face%phase)))
    allocate (product%load(size(loads), most, size(face%phase)), source=0.0_dp)
    allocate (product%touching(most, size(face%phase)), source=huge(1.0_dp))
    do i = 1, size(face%phase)
      call place_slices(mesh, law, alignment, load, loads(size(loads)), i, face, lines, shaft)
      associate (slant => mesh%slant(), first => lines%first)
        line_load = lines%width
        rate = lines%width
        do k = 1, size(loads)
          call solve_contact(mesh%pair%gear(1)%spec%module*lines%compliance, lines%width, lines%gap*slant, lines%flat, &
                             loads(k)/slant, product%deflection(k, i), line_load, rate, error)
          if (allocated(error)) return
          do j = 1, face%pairs(i)
            product%load(k, j, i) = slant*sum(lines%width(first(j):first(j + 1) - 1)*line_load(first(j):first(j + 1) - 1))
          end do
        end do
        product%deflection(:, i) = product%deflection(:, i)/slant
        do j = 1, face%pairs(i)
          if (first(j + 1) > first(j)) product%touching(j, i) = minval(lines%gap(first(j):first(j + 1) - 1))
        end do
      end associate
    end do
  end subroutine find_pair_loads

  !> Checks faces and loads (N), cuts the face into slices for the `largest` load, and chooses the phases.
  subroutine cut_face(mesh, alignment, load, largest, product, law, error, slices, shaft)
    type(face_mesh_t), intent(in) :: mesh
    type(alignment_t), intent(in) :: alignment
    real(dp), intent(in) :: load, largest
    type(face_load_t), intent(out) :: product
    type(face_law_t), intent(out) :: law(2)
    type(error_t), allocatable, intent(inout) :: error
    integer, intent(in), optional :: slices
    type(shaft_t), intent(in), optional :: shaft
    real(dp) :: half_width
    integer :: wanted

    wanted = 0
    if (present(slices)) wanted = slices
    associate (module => mesh%pair%gear(1)%spec%module, path => mesh%pair%contact_ratio*[0.0_dp, 0.5_dp, 1.0_dp])
      if (.not. load > 0) call fail(error, code_input, 'load (N) = '//str(load)//': must be above 0')
      if (.not. abs(mesh%pair%gear(1)%spec%helix_angle) <= (1 + 1e-12_dp)*most_helix) call fail(error, code_input, &
        'helix angle (deg) = '//str(abs(mesh%pair%gear(1)%spec%helix_angle)*180/pi)//': must be at most '// &
        str(most_helix*180/pi)//' for a load distribution over the face')
      if (.not. mesh%width >= least_width*module) call fail(error, code_input, 'face width (mm) = '//str(1000*mesh%width)// &
        ': must be at least '//str(least_width)//' modules for a load distribution over it')
      call check_alignment(alignment, mesh%width, error)
      if (present(shaft)) call check_shaft(shaft, mesh%width, error)
      if (allocated(error)) return
      half_width = maxval(mesh%half_width(path, largest/mesh%width))
      call check_contact(half_width, module, largest/mesh%width, error)
      if (allocated(error)) return
      associate (bounds => graded_slices(mesh%width, module, [alignment%lead%end_relief_length], slice_over_contact*half_width, &
                                         wanted))
        allocate (product%bounds(0:size(bounds) - 1), source=bounds)
      end associate
    end associate
    product%gap = alignment%gap(mesh%width, product%middle())
    if (present(shaft)) product%gap = product%gap + shaft%gap(load, mesh%width, product%middle())
    call find_law(mesh, product%bounds, law, error)
    if (.not. allocated(error)) call place_phases(mesh, size(product%gap), product)
  end subroutine cut_face

  !> Middle of each slice, m.
  pure function middle(product)
    class(face_load_t), intent(in) :: product
    real(dp) :: middle(ubound(product%bounds, 1))

    middle = middle_of(product%bounds)
  end function middle

  !> Middle of each slice between these bounds, m.
  pure function middle_of(bounds) result(middle)
    real(dp), intent(in) :: bounds(0:)
    real(dp) :: middle(ubound(bounds, 1))

    middle = (bounds(:ubound(bounds, 1) - 1) + bounds(1:))/2
  end function middle_of

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

  !> Computes the law of both gears: the pinion's flank is acute at z = 0, the gear's at the other end face.
  pure subroutine find_law(mesh, bounds, law, error)
    type(face_mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: bounds(0:)
    type(face_law_t), intent(out) :: law(2)
    type(error_t), allocatable, intent(inout) :: error
    real(dp) :: shared(1), remainder(1), tilt
    integer :: i

    tilt = tan(abs(mesh%pair%gear(1)%spec%helix_angle))
    do i = 1, 2
      call mesh%at_plane(i, [mesh%pair%contact_ratio/2], remainder, shared)
      if (.not. remainder(1) > 0) then
        call fail(error, code_input, 'plane compliance times E/(1 - nu**2) = '// &
                  str(remainder(1) + shared(1) + even_half_space)//': must be above that of a half space and of the body, '// &
                  str(even_half_space + shared(1)))
        return
      end if
      call make_face_law(bounds/mesh%slant()/mesh%pair%gear(1)%spec%module, remainder(1), shared(1), law(i), &
                         merge(tilt, -tilt, i == 1))
    end do
  end subroutine find_law

  !> Chooses the phases: in equal steps over each interval in which no line begins, ends or reaches an end face, an even number of
  !> steps; of spur gears the last interval has the fewest pairs. Shares are those of the trapezoidal rule.
  pure subroutine place_phases(mesh, slices, product)
    type(face_mesh_t), intent(in) :: mesh
    integer, intent(in) :: slices
    type(face_load_t), intent(inout) :: product
    integer, parameter :: phases = 32            ! about this number
    real(dp), parameter :: rounding = 1e-9_dp
    real(dp) :: ends(5), overlap
    integer :: i, k, n, pairs

    overlap = mesh%pair%lag()*mesh%width
    associate (ratio => mesh%pair%contact_ratio)
      ends = [0.0_dp, ratio - aint(ratio), overlap - aint(overlap), modulo(ratio + overlap, 1.0_dp), 1.0_dp]
    end associate
    ends(2:4) = sorted(ends(2:4))
    allocate (product%phase(0), product%share(0), product%pairs(0))
    do i = 1, 4
      associate (length => ends(i + 1) - ends(i))
        if (.not. length > merge(rounding, 0.0_dp, overlap > 0)) cycle
        n = 2*max(1, nint(phases*length/2))
        product%phase = [product%phase, [(ends(i) + length*k/n, k=0, n)]]
        product%share = [product%share, [(length/n*merge(0.5_dp, 1.0_dp, k == 0 .or. k == n), k=0, n)]]
        pairs = int(mesh%pair%contact_ratio + overlap - (ends(i) + length/2)) + 1
        product%pairs = [product%pairs, [(pairs, k=0, n)]]
      end associate
    end do
    n = size(product%phase)
    allocate (product%line_load(slices, maxval(product%pairs), n), source=0.0_dp)
    allocate (product%pressure, product%path, source=product%line_load)
    allocate (product%error(n), product%stiffness(n), product%factor(n), product%contact(n))
    allocate (product%pair_load(maxval(product%pairs), n), source=0.0_dp)
    allocate (product%pair_stiffness, source=product%pair_load)
    allocate (product%deflection, source=product%error)
  end subroutine place_phases

  !> Cuts the lines of contact at the phase of `row` into slices, and adds the bounds at their ends inside the face to the law of
  !> both gears.
  pure subroutine place_lines(mesh, load, row, product, law, line)
    type(face_mesh_t), intent(in) :: mesh
    real(dp), intent(in) :: load
    integer, intent(in) :: row
    type(face_load_t), intent(in) :: product
    type(face_law_t), intent(inout) :: law(2)
    type(line_t), intent(out) :: line(:)         !< (pair)
    real(dp) :: ends(2), least
    real(dp), allocatable :: added(:)
    integer, allocatable :: inner(:)
    logical :: is_inside(2)
    integer :: i, j, n, known

    n = ubound(product%bounds, 1)
    known = n + 1
    allocate (added(0))
    least = least_part*max(minval(product%bounds(1:) - product%bounds(:n - 1)), &
                           slice_over_contact*mesh%half_width(mesh%pair%contact_ratio/2, load/mesh%width))
    do j = 1, size(line)
      line(j)%start = product%phase(row) + (j - 1)
      ends = [product%bounds(0), product%bounds(n)]
      if (mesh%pair%overlap_ratio > 0) ends = [max(ends(1), (line(j)%start - mesh%pair%contact_ratio)/mesh%pair%lag()), &
                                               min(ends(2), line(j)%start/mesh%pair%lag())]
      is_inside = [ends(1) > product%bounds(0), ends(2) < product%bounds(n)]
      inner = pack([(i, i=1, n - 1)], product%bounds(1:n - 1) - ends(1) > merge(least, 0.0_dp, is_inside(1)) .and. &
                   ends(2) - product%bounds(1:n - 1) > merge(least, 0.0_dp, is_inside(2)))
      if (ends(2) - ends(1) < least) then
        ! Next to a corner of the field of contact.
        allocate (line(j)%list(1), line(j)%bounds(0:0), line(j)%s(0))
        line(j)%list = 1
        line(j)%bounds = ends(1)
        cycle
      end if
      line(j)%list = [1, inner + 1, n + 1]
      if (is_inside(1)) line(j)%list(1) = known + size(added) + 1
      if (is_inside(1)) added = [added, ends(1)]
      if (is_inside(2)) line(j)%list(size(line(j)%list)) = known + size(added) + 1
      if (is_inside(2)) added = [added, ends(2)]
      allocate (line(j)%bounds(0:size(inner) + 1))
      line(j)%bounds = [ends(1), product%bounds(inner), ends(2)]
      line(j)%s = line(j)%start - mesh%pair%lag()*middle_of(line(j)%bounds)
      if (.not. mesh%pair%overlap_ratio > 0) line(j)%s = min(line(j)%s, mesh%pair%contact_ratio)
    end do
    if (size(added) == 0) return
    do i = 1, 2
      call law(i)%add_bounds(added/mesh%slant()/mesh%pair%gear(1)%spec%module)
    end do
  end subroutine place_lines

  !> Mean of a line's values over each slice of the face between the `bounds` (m); 0 where the line does not run.
  pure function onto_face(line, values, bounds) result(mean)
    class(line_t), intent(in) :: line
    real(dp), intent(in) :: values(:), bounds(0:)
    real(dp) :: mean(ubound(bounds, 1))
    integer :: i

    associate (n => size(values))
      mean = [(sum(values*max(0.0_dp, min(line%bounds(1:), bounds(i)) - max(line%bounds(:n - 1), bounds(i - 1)))) &
               /(bounds(i) - bounds(i - 1)), i=1, size(mean))]
    end associate
  end function onto_face

  !> Cuts the lines of contact at the phase of `row` into slices, for the `largest` load, with their gaps and compliance.
  subroutine place_slices(mesh, of_face, alignment, load, largest, row, product, lines, shaft)
    type(face_mesh_t), intent(in) :: mesh
    type(face_law_t), intent(in) :: of_face(2)
    type(alignment_t), intent(in) :: alignment
    real(dp), intent(in) :: load, largest        ! static and largest load, N
    integer, intent(in) :: row
    type(face_load_t), intent(in) :: product
    type(lines_t), intent(out) :: lines
    type(shaft_t), intent(in), optional :: shaft
    type(face_law_t) :: law(2)
    integer :: i, j, k

    law = of_face
    allocate (lines%line(product%pairs(row)))
    call place_lines(mesh, largest, row, product, law, lines%line)
    associate (line => lines%line)
      lines%first = [1, (1 + sum([(size(line(k)%s), k=1, j)]), j=1, size(line))]
      associate (n => lines%first(size(line) + 1) - 1)
        allocate (lines%width(n), lines%gap(n), lines%square(n), lines%compliance(n, n))
      end associate
      do j = 1, size(line)
        associate (own => [(i, i=lines%first(j), lines%first(j + 1) - 1)], s => line(j)%s, bounds => line(j)%bounds)
          if (size(own) == 0) cycle
          lines%width(own) = (bounds(1:) - bounds(:size(own) - 1))/mesh%slant()
          lines%gap(own) = gap_of(line(j))
          if (allocated(mesh%profile_error%breaks)) &
            lines%gap(own) = lines%gap(own) + [(mesh%profile_error%value(s(i)), i=1, size(s))]
          lines%square(own) = mesh%half_width(s, 1.0_dp)**2
          lines%compliance(own, own) = of_line(line(j))
          do k = j + 1, size(line)
            associate (other => [(i, i=lines%first(k), lines%first(k + 1) - 1)])
              if (size(other) == 0) cycle
              lines%compliance(own, other) = between_lines(line(j), line(k), k - j)
              lines%compliance(other, own) = transpose(lines%compliance(own, other))
            end associate
          end do
        end associate
      end do
    end associate
    lines%flat = flat_t(2/pi*sum(1/[mesh%tooth%modulus]), lines%square/mesh%pair%gear(1)%spec%module**2)

  contains

    !> Gap of the flanks over the slices of a line, without profile error, m.
    pure function gap_of(line) result(gap)
      type(line_t), intent(in) :: line
      real(dp) :: gap(size(line%s))
      real(dp) :: shaft_gap(size(product%gap) + size(gap))

      gap = alignment%gap(mesh%width, middle_of(line%bounds))
      if (.not. present(shaft)) return
      ! From the place of the face where the shaft leaves no gap.
      shaft_gap = shaft%gap(load, mesh%width, [product%middle(), middle_of(line%bounds)])
      associate (n => size(product%gap))
        gap = gap + (shaft_gap(n + 1:) - minval(shaft_gap(:n)))
      end associate
    end function gap_of

    !> Compliance of both gears over the slices of a line, 1/Pa.
    pure function of_line(line)
      type(line_t), intent(in) :: line
      real(dp) :: of_line(size(line%s), size(line%s)), remainder(size(line%s)), shared(size(line%s))
      type(line_law_t) :: terms
      integer :: i

      of_line = 0
      do i = 1, 2
        call mesh%at_plane(i, line%s, remainder, shared)
        terms = law(i)%of_line(line%list)
        of_line = of_line + terms%of_tooth(remainder, shared)/mesh%tooth(i)%modulus
      end do
    end function of_line

    !> Compliance that a line shares with the one `later` teeth after it, 1/Pa.
    pure function between_lines(line, next, later) result(shared)
      type(line_t), intent(in) :: line, next
      integer, intent(in) :: later
      real(dp) :: shared(size(line%s), size(next%s)), here(size(line%s)), there(size(next%s))
      integer :: i, j

      shared = 0
      do i = 1, 2
        here = with_next(i, line%s, later)
        there = with_next(i, line%start - mesh%pair%lag()*middle_of(next%bounds), later)
        associate (term => law(i)%between(line%list, next%list))
          do j = 1, size(there)
            shared(:, j) = shared(:, j) + mean_of(here, there(j))*term(:, j)
          end do
        end associate
      end do
    end function between_lines

    !> Compliance that a tooth of a gear shares with the one `later` teeth after it, m2/N; `s`: of the earlier one.
    pure function with_next(gear, s, later) result(shared)
      integer, intent(in) :: gear, later
      real(dp), intent(in) :: s(:)
      real(dp) :: shared(size(s)), none(size(s))
      integer :: i

      associate (of => mesh%tooth(gear)%shared)
        shared = [(of%value(min(max(s(i), 0.0_dp), of%breaks(size(of%breaks)))), i=1, size(s))]
      end associate
      if (later > 1) shared = mesh%tooth(gear)%beyond
      none = 0
      call make_oblique(tan(mesh%pair%gear(1)%spec%helix_angle), none, shared)
    end function with_next
  end subroutine place_slices

  !> Finds the loads at the phase of `row`.
  subroutine solve_phase(mesh, lines, load, row, product, error)
    type(face_mesh_t), intent(in) :: mesh
    type(lines_t), intent(in) :: lines
    real(dp), intent(in) :: load
    integer, intent(in) :: row
    type(face_load_t), intent(inout) :: product
    type(error_t), allocatable, intent(inout) :: error
    real(dp), dimension(size(lines%width)) :: line_load, rate
    real(dp) :: turn, slant
    integer :: i, j

    slant = mesh%slant()
    call solve_contact(mesh%pair%gear(1)%spec%module*lines%compliance, lines%width, lines%gap*slant, lines%flat, load/slant, &
                       product%error(row), line_load, rate, error)
    if (allocated(error)) return
    turn = sum([mesh%tooth%turn])/mesh%width
    product%deflection(row) = product%error(row)/slant
    product%error(row) = product%deflection(row) + turn*load
    do j = 1, size(lines%line)
      associate (own => lines%width(lines%first(j):lines%first(j + 1) - 1))
        product%pair_load(j, row) = sum(own*line_load(lines%first(j):lines%first(j + 1) - 1))*slant
        product%pair_stiffness(j, row) = sum(own*rate(lines%first(j):lines%first(j + 1) - 1))*slant**2
      end associate
    end do
    product%stiffness(row) = sum(product%pair_stiffness(:, row))
    product%stiffness(row) = product%stiffness(row)/(1 + turn*product%stiffness(row))
    do j = 1, size(lines%line)
      associate (w => line_load(lines%first(j):lines%first(j + 1) - 1), bounds => product%bounds)
        product%path(:, j, row) = lines%line(j)%start - mesh%pair%lag()*product%middle()
        if (size(w) == 0) cycle
        if (mesh%pair%overlap_ratio > 0) then
          product%line_load(:, j, row) = lines%line(j)%onto_face(w, bounds)
        else
          product%path(:, j, row) = min(product%phase(row) + j - 1, mesh%pair%contact_ratio)
          product%line_load(:, j, row) = w
        end if
      end associate
    end do
    product%contact(row) = sum(lines%width, mask=line_load > 0)/sum(lines%width)
    where (line_load > 0) line_load = 2*sqrt(line_load/lines%square)/pi
    do j = 1, size(lines%line)
      associate (p => line_load(lines%first(j):lines%first(j + 1) - 1), bounds => lines%line(j)%bounds)
        do i = 1, size(p)
          where (product%bounds(1:) > bounds(i - 1) .and. product%bounds(:size(product%gap) - 1) < bounds(i)) &
            product%pressure(:, j, row) = max(product%pressure(:, j, row), p(i))
        end do
      end associate
    end do
    product%factor(row) = largest_mean(product%bounds, product%load_at(row), mesh%pair%gear(1)%spec%module)/(load/mesh%width)
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
    associate (b => product%bounds, m => mesh%pair%gear(1)%spec%module)
      edge = [load_between(b, mean, 0.0_dp, m), load_between(b, mean, mesh%width - m, mesh%width)]
      product%edge_load = maxval(edge)/(m*per)
    end associate
    spread = root_spread(product%bounds/mesh%pair%gear(1)%spec%module)
    if (mesh%pair%overlap_ratio > 0) then
      product%single_factor = product%mean_factor
      product%in_contact = sum(product%share*product%contact)
      product%root_factor = root_factor(mean)
      return
    end if
    ! The last interval, from B to D.
    last = size(product%phase)
    first = findloc(product%pairs, product%pairs(last), 1)
    single = (first + last)/2
    product%single_factor = product%factor(single)
    associate (n => size(product%gap))
      product%in_contact = sum(product%bounds(1:) - product%bounds(:n - 1), mask=product%load_at(single) > 0)/mesh%width
    end associate
    product%root_factor = max(root_factor(product%line_load(:, product%pairs(last), last)), &
                              root_factor(product%line_load(:, 1, first)))

  contains

    !> Largest root stress under a line load over that of its mean.
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
