
/* Columns of STATION and SPRING_LAW, and links of stations. */
enum { MEAN, PHASE, SIZE, COSINE, SQUARE, OVER, INERTIA, LOAD, VISCOUS, QUADRATIC, SHARE };
enum { ROOT, SHAFT, CROSS, RATIO, FOURIER };
enum { FIRST_STAGE, STAGES, FIRST_WAVE, ERRORS, SWELLS };

/* Sum of harmonics of a mesh by the mean rotation, and its slope. */
static void mesh(int first, int count, double angle, double *value, double *slope)
{
  int i;
  *value = 0.0;
  *slope = 0.0;
  for (i = first; i < first + count; i++) {
    double at = WAVE[i][1] * angle + WAVE[i][2];
    *value += WAVE[i][0] * cos(at);
    *slope -= WAVE[i][0] * sin(at) * WAVE[i][1];
  }
}

/* Springs with stages. A row of STAGE is: damping, slope and offset of the torque; three guards of four numbers
   a, e, h, d: the stage ends where a q + e q' - h crosses zero in the direction d (0: no such guard); and damping that
   goes with the depth of contact, by the twist and at twist 0. The stage of a twist and its rate is the one whose guards are
   all on the side where it lasts, or nearest to it. */
static int stage_of(int spring, double twist, double rate)
{
  int first = SPRING_LAW[spring][FIRST_STAGE], best = first, i, g;
  double depth = -HUGE_VAL;
  for (i = first; i < first + SPRING_LAW[spring][STAGES]; i++) {
    double least = HUGE_VAL;
    for (g = 3; g < 15; g += 4) {
      double d = STAGE[i][g + 3];
      if (d != 0.0) {
        double left = -d * (STAGE[i][g] * twist + STAGE[i][g + 1] * rate - STAGE[i][g + 2]);
        least = left < least ? left : least;
      }
    }
    if (least > depth) {
      best = i;
      depth = least;
    }
  }
  return best;
}

/* Deviation [rad] and speed [rad/s] of every station; of every spring its twist [rad], between its teeth where it is a
   mesh, how fast that grows, and the torque it carries [N m]. */
typedef struct {
  double deviation[STATIONS], speed[STATIONS];
  double twist[SPRINGS_OR_ONE], rate[SPRINGS_OR_ONE], torque[SPRINGS_OR_ONE];
} Motion;

/* Rates dx of the states x at the time t [s]; of every spring its row of STAGE, or 0 for those that twist and rate
   tell; torques on the stations from outside [N m], or 0 for none; and the motion besides. */
static void line_equations(double t, const double *x, const int *stages, const double *applied, double *dx,
                           Motion *motion)
{
  double *d = motion->deviation, *v = motion->speed, r[STATIONS], r1[STATIONS];
  double inertia[UNKNOWNS], slope[UNKNOWNS], torque[UNKNOWNS];
  double theta = (INPUT[1] + 0.5 * INPUT[2] * t) * t + INPUT[0], omega = INPUT[1] + INPUT[2] * t;
  double turned = theta, turning = omega;
  int s, e, h, i;

  for (i = 0; i < UNKNOWNS; i++) {
    inertia[i] = 0.0;
    slope[i] = 0.0;
    torque[i] = 0.0;
  }
  /* Deviation d, speed v, and r = da/da_first with its slope of every station. */
  for (s = 0; s < STATIONS; s++) {
    const double *p = STATION[s];
    int b = STATION_PLACES[s][0], link = STATION_PLACES[s][1];
    double chi, c, sn, lead, eta, bend;
    i = STATION_PLACES[s][2];
    if (link == ROOT || link == SHAFT) {
      d[s] = i >= 0 ? x[i] : 0.0;
      v[s] = p[MEAN] * omega + (i >= 0 ? x[UNKNOWNS + i] : 0.0);
      r[s] = 1.0;
      r1[s] = 0.0;
      continue;
    }
    if (link == RATIO) {
      d[s] = d[b] * p[OVER];
      v[s] = v[b] * p[OVER];
      r[s] = r[b] * p[OVER];
      r1[s] = r1[b] * p[OVER];
      continue;
    }
    chi = p[MEAN] * theta + d[b] + p[PHASE];
    if (link == CROSS) {
      double below;
      c = cos(2.0 * chi);
      sn = sin(2.0 * chi);
      lead = atan(p[SIZE] * sn / (1.0 - p[SIZE] * c));
      below = 1.0 / (1.0 - p[SQUARE] * (1.0 + c) / 2.0);
      eta = p[COSINE] * below;
      bend = -eta * p[SQUARE] * sn * below;
    } else {
      lead = 0.0;
      eta = 1.0;
      bend = 0.0;
      for (i = (int)p[SIZE]; i < (int)p[SIZE] + (int)p[COSINE]; i++) {
        double m = RIPPLE[i][0];
        c = RIPPLE[i][1] * cos(m * chi + RIPPLE[i][2]);
        sn = RIPPLE[i][1] * sin(m * chi + RIPPLE[i][2]);
        lead += sn;
        eta += m * c;
        bend -= m * m * sn;
      }
    }
    d[s] = d[b] + lead;
    v[s] = eta * v[b];
    r[s] = eta * r[b];
    r1[s] = eta * r1[b] + bend * r[b] * r[b];
  }
  /* The mean rotation, by which meshes run. */
  for (s = 0; s < STATIONS; s++) {
    turned += STATION[s][SHARE] * d[s];
    turning += STATION[s][SHARE] * (v[s] - STATION[s][MEAN] * omega);
  }
  for (s = 0; s < STATIONS; s++) {
    const double *p = STATION[s];
    i = STATION_PLACES[s][2];
    if (i >= 0) {
      inertia[i] += p[INERTIA] * r[s] * r[s];
      slope[i] += p[INERTIA] * r[s] * r1[s];
      torque[i] -= r[s] * (p[LOAD] + (p[VISCOUS] + p[QUADRATIC] * fabs(v[s])) * v[s]);
      if (applied)
        torque[i] += r[s] * applied[s];
    }
  }
  for (h = 0; h < TORQUES; h++) {
    s = (int)TORQUE[h][0];
    i = STATION_PLACES[s][2];
    if (i >= 0) {
      double angle = STATION[s][MEAN] * theta + d[s];
      torque[i] += r[s] * TORQUE[h][1] * cos(TORQUE[h][4] + TORQUE[h][3] * t + TORQUE[h][2] * angle);
    }
  }
  for (e = 0; e < SPRINGS; e++) {
    int near_end = SPRING_ENDS[e][0], far_end = SPRING_ENDS[e][1];
    double twist = d[far_end] - d[near_end], rate = v[far_end] - v[near_end], carried;
    if (SPRING_LAW[e][STAGES] == 0) {
      carried = SPRING[e][0] * twist + SPRING[e][1] * rate;
    } else {
      const double *stage;
      double error, wave, grows;
      int first = SPRING_LAW[e][FIRST_WAVE], errors = SPRING_LAW[e][ERRORS];
      mesh(first, errors, turned, &error, &grows);
      twist += error;
      rate += grows * turning;
      mesh(first + errors, SPRING_LAW[e][SWELLS], turned, &wave, &grows);
      stage = stages ? STAGE[stages[e]] : STAGE[stage_of(e, twist, rate)];
      carried = (1.0 + wave) * (stage[1] * twist + stage[2]) + (stage[0] + stage[15] * twist + stage[16]) * rate;
    }
    motion->twist[e] = twist;
    motion->rate[e] = rate;
    motion->torque[e] = carried;
    i = SPRING_ENDS[e][3];
    if (i >= 0)
      torque[i] -= carried;
    i = SPRING_ENDS[e][2];
    if (i >= 0)
      torque[i] += r[near_end] * carried;
  }
  for (s = 0; s < STATIONS; s++) {
    i = STATION_PLACES[s][2];
    if (i >= 0 && STATION_PLACES[s][3] == s) {
      dx[i] = x[UNKNOWNS + i];
      dx[UNKNOWNS + i] = (torque[i] - slope[i] * v[s] * v[s]) / inertia[i] - STATION[s][MEAN] * INPUT[2];
    }
  }
}
