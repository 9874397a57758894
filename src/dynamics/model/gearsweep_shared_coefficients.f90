!> Coefficients of the equation of motion where pairs share compliances, for each step: in series with one that both pairs share
!> (gearsweep_shared_compliance), or by the matrix of three pairs and more (gearsweep_coupled_pairs).
module gearsweep_shared_coefficients
  use gearsweep_coefficient_table, only: coefficients_t
  use gearsweep_coupled_pairs, only: compliances, respond, sum_response, touching
  use gearsweep_kinds, only: dp
  use gearsweep_mesh, only: coupling, interval_t
  use gearsweep_nodes, only: nodes, stiff_nodes
  use gearsweep_oscillator, only: oscillator_t
  use gearsweep_shared_compliance, only: reduce_sums
  implicit none
  private
  public :: share_compliance, fill_shared, sum_at_node, respond_at_end, touching_at_end, couple_coast

contains

  !> Turns the sums over pairs by themselves into what they are while these share a compliance.
  pure subroutine share_compliance(osc, table)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(inout) :: table
    real(dp) :: a, b
    integer :: i, j, k

    do i = 1, table%steps
      do k = 1, 3
        if (table%coupled(i)) then
          call sum_at_node(osc, table, i, k, table%full(i), table%omega_squared(k, i), table%forcing(k, i))
          cycle
        end if
        a = 0
        b = 0
        do j = 1, table%pairs(i)
          if (.not. btest(table%full(i), j - 1)) cycle
          a = a + table%node_stiffness(j, k, i)
          b = b + table%node_stiffness(j, k, i)*table%profile_error(j, k, i)
        end do
        call reduce_sums(table%node_shared(1, k, i), a, b, table%omega_squared(k, i), table%forcing(k, i))
      end do
    end do
  end subroutine share_compliance

  !> What neighbours share over the steps first to last, those of one smooth interval.
  pure subroutine fill_shared(interval, first, last, table)
    type(interval_t), intent(in) :: interval
    integer, intent(in) :: first, last
    type(coefficients_t), intent(inout) :: table
    real(dp) :: phase
    integer :: i, j, k

    do i = first, last
      do j = 1, size(interval%shared, 2)
        associate (c0 => interval%shared(0, j), c1 => interval%shared(1, j), c2 => interval%shared(2, j))
          do k = 1, 3
            phase = table%left(i) + table%width(i)*merge(stiff_nodes(k), nodes(k), table%kind(i)%stiff)
            table%node_shared(j, k, i) = c0 + phase*(c1 + phase*c2)
          end do
          do k = 1, 2
            phase = table%left(i) + (k - 1)*table%width(i)
            table%end_shared(0, j, k, i) = c0 + phase*(c1 + phase*c2)
            table%end_shared(1, j, k, i) = c1 + 2*phase*c2
            table%end_shared(2, j, k, i) = 2*c2
          end do
        end associate
      end do
    end do
  end subroutine fill_shared

  !> omega^2 (1/s^2) and sum of k e (m/s^2) of a contact set of coupled pairs at a node of a step.
  pure subroutine sum_at_node(osc, table, step, node, contact_set, omega_squared, forcing)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, node            !< which of the three
    integer, intent(in) :: contact_set           !< bit j - 1: pair j is in contact
    real(dp), intent(out) :: omega_squared, forcing

    associate (p => table%pairs(step), i => step, k => node)
      call sum_response(contact_set, coupling(osc%mesh, table%node_stiffness(:p, k, i), table%node_shared(:p - 1, k, i)), &
                        table%profile_error(:p, k, i), table%rate(:p, k, i)/table%node_stiffness(:p, k, i), omega_squared, &
                        forcing)
    end associate
  end subroutine sum_at_node

  !> The matrix of coupled pairs at an end of a step, with its derivatives over the phase, (0:2, pair, pair), and what its
  !> loads are.
  pure subroutine respond_at_end(osc, table, step, end, contact_set, c, g, h)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, end             !< which step; 1 its begin, 2 its end
    integer, intent(in) :: contact_set           !< bit j - 1: pair j is in contact
    real(dp), intent(out) :: c(0:2, table%pairs(step), table%pairs(step))  !< m/N
    real(dp), intent(out), dimension(0:2, table%pairs(step)) :: g, h       !< of gearsweep_coupled_pairs

    associate (p => table%pairs(step))
      c = compliances(table%end_stiffness(:, :p, end, step), table%end_shared(:, :p - 1, end, step), &
                      osc%mesh%disc%shared_beyond())
      call respond(contact_set, c, table%end_profile_error(:, :p, end, step), g, h)
    end associate
  end subroutine respond_at_end

  !> The deflection (m) at which pair j just touches while the others of a contact set do, with its derivatives over the phase, at
  !> an end of a step with coupled pairs.
  pure function touching_at_end(osc, table, step, end, contact_set, j) result(x)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(in) :: table
    integer, intent(in) :: step, end             !< which step; 1 its begin, 2 its end
    integer, intent(in) :: contact_set           !< bit j - 1: pair j is in contact
    integer, intent(in) :: j                     !< whether it is in contact does not matter
    real(dp) :: x(0:2)
    real(dp) :: c(0:2, table%pairs(step), table%pairs(step))
    real(dp), dimension(0:2, table%pairs(step)) :: g, h

    call respond_at_end(osc, table, step, end, ibclr(contact_set, j - 1), c, g, h)
    x = touching(j, c, table%end_profile_error(:, j, end, step), g, h)
  end function touching_at_end

  !> The same in a step with coupled pairs.
  pure subroutine couple_coast(osc, table, step)
    type(oscillator_t), intent(in) :: osc
    type(coefficients_t), intent(inout) :: table
    integer, intent(in) :: step
    real(dp), dimension(table%pairs(step)) :: none, push
    real(dp) :: nothing
    integer :: k

    none = 0
    push = sum(1/osc%mass)
    do k = 1, size(nodes)
      associate (p => table%pairs(step))
        call sum_response(table%between(step), coupling(osc%mesh, table%node_stiffness(:p, k, step), &
                                                        table%node_shared(:p - 1, k, step)), none, push, &
                          table%rate(osc%contacts, k, step), nothing)
      end associate
    end do
  end subroutine couple_coast
end module gearsweep_shared_coefficients
