! datasets/four_bar_gravity.toml for auto-07p: the angles u of crank, coupler and rocker as the mass PAR(1) of the
! coupler varies. Two closures and virtual work, N^T Q = 0 with N the cross product of the closure Jacobian's rows, over
! the acceleration of gravity; exact derivatives.
subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision, parameter :: crank = 2, coupler = 3.5d0, rocker = 3, across = 4, up = 1
  double precision, parameter :: crank_moment = 2, rocker_moment = 4.5d0  ! mass times distance of its centre
  double precision :: c(3), s(3), n(3), m(3), q(3), dq(3)

  c = cos(u)
  s = sin(u)
  n = (/coupler * rocker * (s(2) * c(3) - c(2) * s(3)), rocker * crank * (s(3) * c(1) - c(3) * s(1)), &
        crank * coupler * (s(2) * c(1) - c(2) * s(1))/)
  q = (/(crank_moment + crank * par(1)) * c(1), 0.5d0 * coupler * par(1) * c(2), rocker_moment * c(3)/)
  f(1) = crank * c(1) + coupler * c(2) - rocker * c(3) - across
  f(2) = crank * s(1) + coupler * s(2) - rocker * s(3) - up
  f(3) = n(1) * q(1) + n(2) * q(2) + n(3) * q(3)
  if (ijac == 0) return

  m = (/coupler * rocker * (c(2) * c(3) + s(2) * s(3)), rocker * crank * (c(3) * c(1) + s(3) * s(1)), &
        crank * coupler * (c(2) * c(1) + s(2) * s(1))/)
  dq = (/-(crank_moment + crank * par(1)) * s(1), -0.5d0 * coupler * par(1) * s(2), -rocker_moment * s(3)/)
  dfdu(1, :) = (/-crank * s(1), -coupler * s(2), rocker * s(3)/)
  dfdu(2, :) = (/crank * c(1), coupler * c(2), -rocker * c(3)/)
  dfdu(3, :) = (/n(1) * dq(1) - m(2) * q(2) - m(3) * q(3), n(2) * dq(2) + m(3) * q(3) + m(1) * q(1), &
                 n(3) * dq(3) - m(1) * q(1) + m(2) * q(2)/)
  if (ijac == 1) return
  dfdp(1:2, 1) = 0
  dfdp(3, 1) = n(1) * crank * c(1) + n(2) * 0.5d0 * coupler * c(2)
end subroutine func
