
/* An instance of the model: what both versions of FMI drive. */
#include <stdlib.h>
#include <string.h>

enum { STATES = 2 * UNKNOWNS, INDICATORS = 3 * CONTACTS };
enum { INDICATORS_OR_ONE = INDICATORS > 0 ? INDICATORS : 1, INPUTS_OR_ONE = INPUTS > 0 ? INPUTS : 1 };
/* Value references: the time, states, their derivatives, inputs, outputs, event indicators. */
enum {
  FIRST_STATE = 1,
  FIRST_DERIVATIVE = FIRST_STATE + STATES,
  FIRST_INPUT = FIRST_DERIVATIVE + STATES,
  FIRST_OUTPUT = FIRST_INPUT + INPUTS,
  FIRST_INDICATOR = FIRST_OUTPUT + OUTPUTS,
  VALUES = FIRST_INDICATOR + INDICATORS
};
enum { BEFORE, INITIALIZING, EVENTS, CONTINUOUS, STEPPING, DONE }; /* what an instance is doing */

/* A contact is entered and left this far [rad] behind its end, so that no event begins at a zero. */
#define BEHIND 1e-12
#define TOLERANCE 1e-9
#define MOST_SWITCHES 64
#define MOST_TRIALS 100

typedef struct {
  double time, tolerance, step;
  double x[STATES], input[INPUTS_OR_ONE];
  int stages[SPRINGS_OR_ONE];
  int doing;
} Model;

static void model_reset(Model *m)
{
  int i, e;
  m->time = 0.0;
  m->tolerance = TOLERANCE;
  m->step = 0.0;
  m->doing = BEFORE;
  for (i = 0; i < STATES; i++)
    m->x[i] = START[i];
  for (i = 0; i < INPUTS_OR_ONE; i++)
    m->input[i] = 0.0;
  for (e = 0; e < SPRINGS_OR_ONE; e++)
    m->stages[e] = 0;
}

static void model_rates(const Model *m, double t, const double *x, double *dx, Motion *motion)
{
  double applied[STATIONS];
  int s, i;
  for (s = 0; s < STATIONS; s++)
    applied[s] = 0.0;
  for (i = 0; i < INPUTS; i++)
    applied[INPUT_AT[i][0]] += m->input[i];
  line_equations(t, x, m->stages, applied, dx, motion);
}

/* How far [rad] a spring is inside its stage, by one of its three guards; 1 where there is no such guard. */
static double inside(const Model *m, const Motion *motion, int contact, int guard)
{
  int e = CONTACT[contact][0];
  const double *p = STAGE[m->stages[e]] + 3 + 4 * guard;
  double size = fabs(p[0]) > 0.0 ? fabs(p[0]) : 1.0;
  return p[3] == 0.0 ? 1.0 : -p[3] * (p[0] * motion->twist[e] + p[1] * motion->rate[e] - p[2]) / size;
}

/* Event indicators: each is positive while the stage lasts. */
static void model_indicators(const Model *m, double t, const double *x, double *z)
{
  double dx[STATES];
  Motion motion;
  int c, g;
  model_rates(m, t, x, dx, &motion);
  for (c = 0; c < CONTACTS; c++)
    for (g = 0; g < 3; g++)
      z[3 * c + g] = inside(m, &motion, c, g) + BEHIND;
}

/* Put every spring into the stage that its twist and rate tell: at the start. */
static void model_locate(Model *m)
{
  double dx[STATES];
  Motion motion;
  int e;
  for (e = 0; e < SPRINGS; e++)
    m->stages[e] = SPRING_LAW[e][FIRST_STAGE];
  model_rates(m, m->time, m->x, dx, &motion);
  for (e = 0; e < SPRINGS; e++)
    if (SPRING_LAW[e][STAGES] > 0)
      m->stages[e] = stage_of(e, motion.twist[e], motion.rate[e]);
}

/* Enter the stages behind every end that has been crossed; returns whether there was one. */
static int model_switch(Model *m)
{
  int switches = 0, found = 1;
  while (found && switches < MOST_SWITCHES) {
    double dx[STATES];
    Motion motion;
    int c, g;
    found = 0;
    model_rates(m, m->time, m->x, dx, &motion);
    for (c = 0; c < CONTACTS && !found; c++)
      for (g = 0; g < 3 && !found; g++) {
        int e = CONTACT[c][0], then = THEN[m->stages[e]][g];
        if (then >= 0 && inside(m, &motion, c, g) < -0.5 * BEHIND) {
          m->stages[e] = SPRING_LAW[e][FIRST_STAGE] + then;
          switches++;
          found = 1;
        }
      }
  }
  return switches > 0;
}

/* The value of a reference; returns 0 where there is none. */
static int model_get(const Model *m, unsigned int reference, double *value)
{
  double dx[STATES], z[INDICATORS_OR_ONE];
  Motion motion;
  int r = (int)reference;
  if (reference >= (unsigned int)VALUES)
    return 0;
  if (r < FIRST_STATE) {
    *value = m->time;
  } else if (r < FIRST_DERIVATIVE) {
    *value = m->x[r - FIRST_STATE];
  } else if (r < FIRST_INPUT) {
    model_rates(m, m->time, m->x, dx, &motion);
    *value = dx[r - FIRST_DERIVATIVE];
  } else if (r < FIRST_OUTPUT) {
    *value = m->input[r - FIRST_INPUT];
  } else if (r < FIRST_INDICATOR) {
    int at = OUTPUT[r - FIRST_OUTPUT][1];
    model_rates(m, m->time, m->x, dx, &motion);
    switch (OUTPUT[r - FIRST_OUTPUT][0]) {
    case ROTATION:
      *value = motion.deviation[at];
      break;
    case TURNING:
      *value = motion.speed[at];
      break;
    case TWIST:
      *value = motion.twist[at];
      break;
    default:
      *value = motion.torque[at];
    }
  } else {
    model_indicators(m, m->time, m->x, z);
    *value = z[r - FIRST_INDICATOR];
  }
  return 1;
}

/* Set an input, or a state before the simulation begins; returns 0 for anything else and for what is not finite. */
static int model_set(Model *m, unsigned int reference, double value)
{
  int r = (int)reference;
  if (reference >= (unsigned int)VALUES || !(fabs(value) < HUGE_VAL))
    return 0;
  if (r >= FIRST_INPUT && r < FIRST_OUTPUT)
    m->input[r - FIRST_INPUT] = value;
  else if (r >= FIRST_STATE && r < FIRST_DERIVATIVE && (m->doing == BEFORE || m->doing == INITIALIZING))
    m->x[r - FIRST_STATE] = value;
  else
    return 0;
  return 1;
}

static int all_finite(const double *values, int count)
{
  int i;
  for (i = 0; i < count; i++)
    if (!(fabs(values[i]) < HUGE_VAL))
      return 0;
  return 1;
}

/* One step of Dormand and Prince (1980), orders 5 and 4: the states y at t + h, their rates there, and the error over
   what is allowed. */
static double model_step(const Model *m, double h, const double *first, double *y, double *last)
{
  static const double at[6] = {0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0};
  static const double a[6][6] = {
    {0.2, 0.0, 0.0, 0.0, 0.0, 0.0},
    {3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0},
    {44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0},
    {19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0},
    {9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0},
    {35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0}
  };
  static const double miss[7] = {71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0,
                                 22.0 / 525.0, -1.0 / 40.0};
  double k[7][STATES], error = 0.0;
  Motion motion;
  int s, i, j;
  memcpy(k[0], first, sizeof k[0]);
  for (s = 0; s < 6; s++) {
    for (i = 0; i < STATES; i++) {
      double sum = 0.0;
      for (j = 0; j <= s; j++)
        sum += a[s][j] * k[j][i];
      y[i] = m->x[i] + h * sum;
    }
    model_rates(m, m->time + at[s] * h, y, k[s + 1], &motion);
  }
  for (i = 0; i < STATES; i++) {
    double sum = 0.0, before = fabs(m->x[i]), now = fabs(y[i]);
    for (j = 0; j < 7; j++)
      sum += miss[j] * k[j][i];
    sum *= h / (m->tolerance * (NOMINAL[i] + (before > now ? before : now)));
    error += sum * sum / STATES;
  }
  memcpy(last, k[6], sizeof k[6]);
  return all_finite(y, STATES) ? sqrt(error) : HUGE_VAL;
}

/* Whether states y at the time t lie behind the end of a stage. */
static int crossed(const Model *m, double t, const double *y)
{
  double z[INDICATORS_OR_ONE];
  int i;
  if (INDICATORS == 0)
    return 0;
  model_indicators(m, t, y, z);
  for (i = 0; i < INDICATORS; i++)
    if (z[i] <= 0.0)
      return 1;
  return 0;
}

/* The length of the step that just crosses the end of a stage, 0 where none within h does. A cubic through both ends
   looks for contacts that begin and end within the step; then steps of their own length are halved. */
static double first_crossing(const Model *m, double h, const double *first, const double *end, const double *last)
{
  double low = 0.0, high = 0.0, y[STATES], dy[STATES];
  int part, i, trial;
  for (part = 1; part <= 8 && high == 0.0; part++) {
    double u = part / 8.0;
    for (i = 0; i < STATES; i++) {
      double jump = end[i] - m->x[i];
      y[i] = m->x[i] + u * jump
             + u * (1.0 - u) * ((1.0 - 2.0 * u) * -jump + (1.0 - u) * h * first[i] - u * h * last[i]);
    }
    if (!crossed(m, m->time + u * h, part < 8 ? y : end))
      continue;
    if (part < 8)
      model_step(m, u * h, first, y, dy);
    if (part == 8 || crossed(m, m->time + u * h, y))
      high = u * h;
  }
  if (high == 0.0)
    return 0.0;
  for (trial = 0; trial < MOST_TRIALS && m->time + low < m->time + high; trial++) {
    double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high)
      break;
    model_step(m, middle, first, y, dy);
    if (crossed(m, m->time + middle, y))
      high = middle;
    else
      low = middle;
  }
  return high;
}

/* Integrate to the time end; returns 0 where no step is short enough. */
static int model_advance(Model *m, double end)
{
  double first[STATES], last[STATES], y[STATES];
  Motion motion;
  int at_once = 0;
  model_switch(m);
  model_rates(m, m->time, m->x, first, &motion);
  if (m->step <= 0.0)
    m->step = STEP;
  while (m->time < end) {
    double left = end - m->time, h = m->step < left ? m->step : left, error, grows, until;
    error = model_step(m, h, first, y, last);
    grows = error > 0.0 ? 0.9 * pow(error, -0.2) : 5.0;
    grows = grows > 5.0 ? 5.0 : (grows < 0.2 ? 0.2 : grows);
    if (!(error <= 1.0)) {
      m->step = grows < 0.9 ? h * grows : 0.2 * h;
      if (m->time + m->step <= m->time)
        return 0;
      continue;
    }
    until = INDICATORS > 0 ? first_crossing(m, h, first, y, last) : 0.0;
    if (until > 0.0) {
      at_once = m->time + until > m->time ? 0 : at_once + 1;
      if (at_once > MOST_SWITCHES)
        return 0;
      model_step(m, until, first, y, last);
      memcpy(m->x, y, sizeof y);
      m->time = until < left ? m->time + until : end;
      model_switch(m);
      model_rates(m, m->time, m->x, first, &motion);
      continue;
    }
    memcpy(m->x, y, sizeof y);
    memcpy(first, last, sizeof last);
    m->time = h < left ? m->time + h : end;
    if (h >= m->step || h * grows > m->step)
      m->step = h * grows;
  }
  return 1;
}
