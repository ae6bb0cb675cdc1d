/* Functions of the nonlinear relations for Siconos (siconos_runner.py): y = h(x), r = g(x, lambda), and their
 * Jacobians, column by column. Siconos' relays give lambda in -sign(y). */

#define ARGUMENTS \
  double time, unsigned x_size, double *x, unsigned lambda_size, double *lambda, double *result, unsigned z_size, \
      double *z
#define UNUSED ((void)time, (void)x_size, (void)x, (void)lambda_size, (void)lambda, (void)result, (void)z_size, (void)z)

/* ---- stick-slip: y = v - 0.2; the friction is the mean of both laws plus lambda times half their difference */
void stick_slip_h(ARGUMENTS) {
  UNUSED;
  result[0] = x[1] - 0.2;
}
void stick_slip_g(ARGUMENTS) {
  UNUSED;
  result[0] = 0.0;
  result[1] = 0.5 * ((1.0 + lambda[0]) / (1.2 - x[1]) - (1.0 - lambda[0]) / (0.8 + x[1]));
}
void stick_slip_dh_dx(ARGUMENTS) {
  UNUSED;
  result[0] = 0.0;
  result[1] = 1.0;
}
void stick_slip_dh_dlambda(ARGUMENTS) {
  UNUSED;
  result[0] = 0.0;
}
void stick_slip_dg_dlambda(ARGUMENTS) {
  UNUSED;
  result[0] = 0.0;
  result[1] = 0.5 * (1.0 / (1.2 - x[1]) + 1.0 / (0.8 + x[1]));
}
void stick_slip_dg_dx(ARGUMENTS) {
  UNUSED;
  const double below = 1.2 - x[1];
  const double above = 0.8 + x[1];
  result[0] = result[1] = result[2] = 0.0;
  result[3] = 0.5 * ((1.0 + lambda[0]) / (below * below) + (1.0 - lambda[0]) / (above * above));
}

/* ---- IRMA with u = 1: step_j = (1 - lambda_j) / 2 of the thresholds as in models/irma.toml */
enum { gal4, swi5_low, swi5_mid, swi5_high, ash1, cbf1, gal80, thresholds, proteins = 5 };
static const int component[thresholds] = {0, 1, 1, 1, 2, 3, 4};
static const double threshold[thresholds] = {0.01, 0.01, 0.06, 0.08, 0.035, 0.04, 0.01};

static double step(const double *lambda, int j) { return 0.5 * (1.0 - lambda[j]); }

void irma_h(ARGUMENTS) {
  UNUSED;
  for (int j = 0; j < thresholds; ++j) result[j] = x[component[j]] - threshold[j];
}
void irma_g(ARGUMENTS) {
  UNUSED;
  result[0] = 1.1e-4 + 9e-4 * step(lambda, cbf1);
  result[1] = 3e-4 + 0.15 * step(lambda, gal4);
  result[2] = 6e-4 + 0.018 * step(lambda, swi5_mid);
  result[3] = step(lambda, swi5_low) * (5e-4 + 0.03 * (1.0 - step(lambda, ash1)));
  result[4] = 7.5e-4 + 0.015 * step(lambda, swi5_high);
}
void irma_dh_dx(ARGUMENTS) {
  UNUSED;
  for (int i = 0; i < thresholds * proteins; ++i) result[i] = 0.0;
  for (int j = 0; j < thresholds; ++j) result[component[j] * thresholds + j] = 1.0;
}
void irma_dh_dlambda(ARGUMENTS) {
  UNUSED;
  for (int i = 0; i < thresholds * thresholds; ++i) result[i] = 0.0;
}
void irma_dg_dlambda(ARGUMENTS) {
  UNUSED;
  for (int i = 0; i < thresholds * proteins; ++i) result[i] = 0.0;
  result[cbf1 * proteins + 0] = -0.5 * 9e-4;
  result[gal4 * proteins + 1] = -0.5 * 0.15;
  result[swi5_mid * proteins + 2] = -0.5 * 0.018;
  result[swi5_low * proteins + 3] = -0.5 * (5e-4 + 0.03 * (1.0 - step(lambda, ash1)));
  result[ash1 * proteins + 3] = 0.5 * 0.03 * step(lambda, swi5_low);
  result[swi5_high * proteins + 4] = -0.5 * 0.015;
}
void irma_dg_dx(ARGUMENTS) {
  UNUSED;
  for (int i = 0; i < proteins * proteins; ++i) result[i] = 0.0;
}
