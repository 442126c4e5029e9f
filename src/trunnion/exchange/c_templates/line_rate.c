
/* Rates dx of the states x at the time t [s]; returns 0. */
int line_rate(double t, const double *x, double *dx)
{
  Motion motion;
  line_equations(t, x, 0, 0, dx, &motion);
  return 0;
}
