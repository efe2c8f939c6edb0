! The hinged chain of benchmarks/paths.cpp for auto-07p: the angles u of its NDIM links as the force PAR(1) varies that
! presses its tip towards its clamp; exact derivatives.
subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision, parameter :: side = 0.01d0
  double precision :: stiffness, length, bend(ndim + 1)
  integer :: i

  stiffness = ndim
  length = 1d0 / ndim
  bend(1) = u(1)
  bend(2:ndim) = u(2:ndim) - u(1:ndim - 1)
  bend(ndim + 1) = 0
  f = stiffness * (bend(1:ndim) - bend(2:ndim + 1)) - length * (par(1) * sin(u) + side * cos(u))
  if (ijac == 0) return

  dfdu(:, 1:ndim) = 0
  do i = 1, ndim
    dfdu(i, i) = merge(2, 1, i < ndim) * stiffness - length * (par(1) * cos(u(i)) - side * sin(u(i)))
    if (i > 1) dfdu(i, i - 1) = -stiffness
    if (i < ndim) dfdu(i, i + 1) = -stiffness
  end do
  if (ijac == 1) return
  dfdp(:, 1) = -length * sin(u)
end subroutine func
