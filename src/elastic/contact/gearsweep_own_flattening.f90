!> How much less a pair of teeth deflects, over its load, as its own load grows.
!>
!> Flanks flatten by less than in proportion to their load: by Hertz the flattening over the load falls with the load's
!> logarithm, alike all along the path of contact. Where a tip corner is in contact it falls faster, because a smaller load acts
!> nearer to the edge: up to two and a half times as fast where the edge alone touches.
module gearsweep_own_flattening
  use gearsweep_kinds, only: dp
  implicit none
  private
  public :: flattening_t, even_flattening, edge_share

  !> What the compliance of a pair falls by as its load grows e times, m/N. In pairs of numbers: at or before A, at or behind E.
  type :: flattening_t
    real(dp) :: within = 0                       !< along the path
    real(dp) :: at_end(2) = 0                    !< at A and E, where the contact ends at the edge
    real(dp) :: beyond(2) = 0                    !< far beyond, where the edge alone touches
    real(dp) :: zone(2) = 0                      !< of the path from A and E on, where the edge is felt, base pitches
    real(dp) :: length(2) = 1                    !< in which what is left to `beyond` falls e times, base pitches
  contains
    procedure :: at
    procedure :: scaled
  end type flattening_t

contains

  !> The same all along: of flanks without edges.
  pure type(flattening_t) function even_flattening(level)
    real(dp), intent(in) :: level                !< m/N

    even_flattening = flattening_t(within=level, at_end=[level, level], beyond=[level, level])
  end function even_flattening

  !> At a path coordinate `s` of a path of this length (contact ratio), both in base pitches; m/N.
  elemental real(dp) function at(self, s, contact_ratio)
    class(flattening_t), intent(in) :: self
    real(dp), intent(in) :: s, contact_ratio
    real(dp) :: past
    integer :: i

    i = merge(1, 2, s < contact_ratio/2)
    past = merge(-s, s - contact_ratio, i == 1)
    if (past > 0) then
      at = self%beyond(i) + (self%at_end(i) - self%beyond(i))*exp(-past/self%length(i))
    else
      at = self%within + (self%at_end(i) - self%within)*edge_share(-past, self%zone(i))
    end if
  end function at

  pure type(flattening_t) function scaled(self, factor)
    class(flattening_t), intent(in) :: self
    real(dp), intent(in) :: factor

    scaled = flattening_t(factor*self%within, factor*self%at_end, factor*self%beyond, self%zone, self%length)
  end function scaled

  !> What the edge changes at a contact so far within the path from its end, over what it changes at the end: 1 to 0 over the
  !> `zone`, smooth up to the second derivative.
  elemental real(dp) function edge_share(distance, zone)
    real(dp), intent(in) :: distance, zone

    edge_share = 0
    if (distance < zone) edge_share = (1 - distance/zone)**3
  end function edge_share
end module gearsweep_own_flattening
