! What auto-07p asks of every set of equations besides FUNC: the start, read from the file "start" (parameter, then
! unknowns), and a record of every point in the file "points": the clock, ns, the parameter and the unknowns, unformatted,
! because AUTO's own file rounds to eleven digits.
subroutine stpnt(ndim, u, par, t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  open (unit=51, file="start", status="old", action="read")
  read (51, *) par(1), u
  close (51)
end subroutine stpnt

! AUTO calls this more than once for a point.
subroutine pvls(ndim, u, par)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(in) :: u(ndim)
  double precision, intent(inout) :: par(*)
  logical, save :: is_open = .false.
  double precision, save :: last = 0
  integer(8) :: count, rate
  if (.not. is_open) then
    open (unit=50, file="points", access="stream", form="unformatted", status="replace")
    is_open = .true.
  else if (par(1) == last) then
    return
  end if
  last = par(1)
  call system_clock(count, rate)
  write (50) count * (1000000000_8 / rate), par(1), u
end subroutine pvls

subroutine bcnd()
end subroutine bcnd

subroutine icnd()
end subroutine icnd

subroutine fopt()
end subroutine fopt
