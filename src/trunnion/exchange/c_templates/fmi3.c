
/* The functions of FMI 3.0, for model exchange and co-simulation. */
#include "fmi3Functions.h"

typedef struct {
  Model model;
  fmi3LogMessageCallback log;
  fmi3InstanceEnvironment environment;
  bool logging;
} Instance;

static fmi3Status wrong(const Instance *c, const char *message)
{
  if (c->logging && c->log)
    c->log(c->environment, fmi3Error, "logStatusError", message);
  return fmi3Error;
}

const char *fmi3GetVersion(void)
{
  return fmi3Version;
}

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[])
{
  (void)n;
  (void)categories;
  ((Instance *)c)->logging = on;
  return fmi3OK;
}

static fmi3Instance instance(fmi3String token, fmi3Boolean logging, fmi3InstanceEnvironment environment,
                             fmi3LogMessageCallback log)
{
  Instance *c;
  if (!token || strcmp(token, MODEL_TOKEN) != 0) {
    if (log)
      log(environment, fmi3Error, "logStatusError", "the instantiation token is not that of these sources");
    return 0;
  }
  c = (Instance *)calloc(1, sizeof(Instance));
  if (!c)
    return 0;
  c->log = log;
  c->environment = environment;
  c->logging = logging;
  model_reset(&c->model);
  return c;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                          fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback log)
{
  (void)name;
  (void)resources;
  (void)visible;
  return instance(token, logging, environment, log);
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean eventModeUsed, fmi3Boolean earlyReturnAllowed,
                                         const fmi3ValueReference required[], size_t n,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update)
{
  (void)name;
  (void)resources;
  (void)visible;
  (void)eventModeUsed;
  (void)earlyReturnAllowed;
  (void)required;
  (void)n;
  (void)update;
  return instance(token, logging, environment, log);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                               fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock)
{
  (void)name;
  (void)token;
  (void)resources;
  (void)visible;
  (void)update;
  (void)lock;
  (void)unlock;
  if (logging && log)
    log(environment, fmi3Error, "logStatusError", "scheduled execution is not provided");
  return 0;
}

void fmi3FreeInstance(fmi3Instance c)
{
  free(c);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
                                       fmi3Float64 startTime, fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
  Model *m = &((Instance *)c)->model;
  (void)stopTimeDefined;
  (void)stopTime;
  m->time = startTime;
  if (toleranceDefined && tolerance > 0.0)
    m->tolerance = tolerance;
  m->doing = INITIALIZING;
  return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
  Model *m = &((Instance *)c)->model;
  model_locate(m);
  m->doing = EVENTS;
  return fmi3OK;
}

fmi3Status fmi3EnterEventMode(fmi3Instance c)
{
  ((Instance *)c)->model.doing = EVENTS;
  return fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance c)
{
  ((Instance *)c)->model.doing = DONE;
  return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance c)
{
  model_reset(&((Instance *)c)->model);
  return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 values[], size_t count)
{
  Instance *own = (Instance *)c;
  size_t i;
  if (n != count)
    return wrong(own, "fmi3GetFloat64: as many values as references, all are scalars");
  if (own->model.doing <= INITIALIZING)
    model_locate(&own->model);
  for (i = 0; i < n; i++)
    if (!model_get(&own->model, vr[i], values + i))
      return wrong(own, "fmi3GetFloat64: there is no such variable");
  return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Float64 values[],
                          size_t count)
{
  Instance *own = (Instance *)c;
  size_t i;
  if (n != count)
    return wrong(own, "fmi3SetFloat64: as many values as references, all are scalars");
  for (i = 0; i < n; i++)
    if (!model_set(&own->model, vr[i], values[i]))
      return wrong(own, "fmi3SetFloat64: no variable that can be set now, or not a finite value");
  return fmi3OK;
}

/* There are no variables of other types. */
#define OTHER_TYPE(Type)                                                                                              \
  fmi3Status fmi3Get##Type(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3##Type values[],              \
                           size_t count)                                                                              \
  {                                                                                                                   \
    (void)vr;                                                                                                         \
    (void)values;                                                                                                     \
    return n || count ? wrong((Instance *)c, "there are no variables of type " #Type) : fmi3OK;                       \
  }                                                                                                                   \
  fmi3Status fmi3Set##Type(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3##Type values[],        \
                           size_t count)                                                                              \
  {                                                                                                                   \
    (void)vr;                                                                                                         \
    (void)values;                                                                                                     \
    return n || count ? wrong((Instance *)c, "there are no variables of type " #Type) : fmi3OK;                       \
  }

OTHER_TYPE(Float32)
OTHER_TYPE(Int8)
OTHER_TYPE(UInt8)
OTHER_TYPE(Int16)
OTHER_TYPE(UInt16)
OTHER_TYPE(Int32)
OTHER_TYPE(UInt32)
OTHER_TYPE(Int64)
OTHER_TYPE(UInt64)
OTHER_TYPE(Boolean)
OTHER_TYPE(String)

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n, size_t sizes[], fmi3Binary values[],
                         size_t count)
{
  (void)vr;
  (void)sizes;
  (void)values;
  return n || count ? wrong((Instance *)c, "there are no variables of type Binary") : fmi3OK;
}

fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const size_t sizes[],
                         const fmi3Binary values[], size_t count)
{
  (void)vr;
  (void)sizes;
  (void)values;
  return n || count ? wrong((Instance *)c, "there are no variables of type Binary") : fmi3OK;
}

fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Clock values[])
{
  (void)vr;
  (void)values;
  return n ? wrong((Instance *)c, "there are no clocks") : fmi3OK;
}

fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Clock values[])
{
  (void)vr;
  (void)values;
  return n ? wrong((Instance *)c, "there are no clocks") : fmi3OK;
}

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state)
{
  if (!*state)
    *state = calloc(1, sizeof(Model));
  if (!*state)
    return wrong((Instance *)c, "fmi3GetFMUState: no memory is left");
  memcpy(*state, &((Instance *)c)->model, sizeof(Model));
  return fmi3OK;
}

fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state)
{
  memcpy(&((Instance *)c)->model, state, sizeof(Model));
  return fmi3OK;
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state)
{
  (void)c;
  free(*state);
  *state = 0;
  return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size)
{
  (void)c;
  (void)state;
  *size = sizeof(Model);
  return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
  if (size < sizeof(Model))
    return wrong((Instance *)c, "fmi3SerializeFMUState: too few bytes");
  memcpy(bytes, state, sizeof(Model));
  return fmi3OK;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
{
  if (size != sizeof(Model))
    return wrong((Instance *)c, "fmi3DeserializeFMUState: not the bytes of such a state");
  if (!*state)
    *state = calloc(1, sizeof(Model));
  if (!*state)
    return wrong((Instance *)c, "fmi3DeserializeFMUState: no memory is left");
  memcpy(*state, bytes, sizeof(Model));
  return fmi3OK;
}

/* What is not provided, and modelDescription.xml does not promise. */
#define NOT_PROVIDED(name, parameters)                                                                                \
  fmi3Status name parameters                                                                                          \
  {                                                                                                                   \
    return wrong((Instance *)c, #name ": is not provided");                                                           \
  }
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

NOT_PROVIDED(fmi3GetNumberOfVariableDependencies, (fmi3Instance c, fmi3ValueReference vr, size_t *n))
NOT_PROVIDED(fmi3GetVariableDependencies,
             (fmi3Instance c, fmi3ValueReference dependent, size_t places[], fmi3ValueReference independents[],
              size_t others[], fmi3DependencyKind kinds[], size_t n))
NOT_PROVIDED(fmi3GetDirectionalDerivative,
             (fmi3Instance c, const fmi3ValueReference unknowns[], size_t n, const fmi3ValueReference knowns[],
              size_t m, const fmi3Float64 seed[], size_t seeds, fmi3Float64 sensitivity[], size_t sensitivities))
NOT_PROVIDED(fmi3GetAdjointDerivative,
             (fmi3Instance c, const fmi3ValueReference unknowns[], size_t n, const fmi3ValueReference knowns[],
              size_t m, const fmi3Float64 seed[], size_t seeds, fmi3Float64 sensitivity[], size_t sensitivities))
NOT_PROVIDED(fmi3EnterConfigurationMode, (fmi3Instance c))
NOT_PROVIDED(fmi3ExitConfigurationMode, (fmi3Instance c))
NOT_PROVIDED(fmi3GetIntervalDecimal, (fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 intervals[],
                                      fmi3IntervalQualifier qualifiers[]))
NOT_PROVIDED(fmi3GetIntervalFraction, (fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3UInt64 counters[],
                                       fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[]))
NOT_PROVIDED(fmi3GetShiftDecimal, (fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 shifts[]))
NOT_PROVIDED(fmi3GetShiftFraction, (fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3UInt64 counters[],
                                    fmi3UInt64 resolutions[]))
NOT_PROVIDED(fmi3SetIntervalDecimal,
             (fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Float64 intervals[]))
NOT_PROVIDED(fmi3SetIntervalFraction, (fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                       const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]))
NOT_PROVIDED(fmi3SetShiftDecimal, (fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Float64 shifts[]))
NOT_PROVIDED(fmi3SetShiftFraction, (fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                    const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]))
NOT_PROVIDED(fmi3GetOutputDerivatives, (fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                        const fmi3Int32 orders[], fmi3Float64 values[], size_t count))
NOT_PROVIDED(fmi3ActivateModelPartition, (fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time))

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c)
{
  (void)c;
  return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *needed, fmi3Boolean *terminate, fmi3Boolean *nominals,
                                    fmi3Boolean *values, fmi3Boolean *timed, fmi3Float64 *time)
{
  model_switch(&((Instance *)c)->model);
  *needed = fmi3False;
  *terminate = fmi3False;
  *nominals = fmi3False;
  *values = fmi3False;
  *timed = fmi3False;
  *time = 0.0;
  return fmi3OK;
}

/* Model exchange. */

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c)
{
  ((Instance *)c)->model.doing = CONTINUOUS;
  return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi3Boolean *enterEventMode, fmi3Boolean *terminate)
{
  (void)c;
  (void)noSetFMUStatePriorToCurrentPoint;
  *enterEventMode = fmi3False;
  *terminate = fmi3False;
  return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 time)
{
  ((Instance *)c)->model.time = time;
  return fmi3OK;
}

fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 x[], size_t n)
{
  if (n != (size_t)STATES)
    return wrong((Instance *)c, "fmi3SetContinuousStates: not the number of states");
  memcpy(((Instance *)c)->model.x, x, n * sizeof(double));
  return fmi3OK;
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 derivatives[], size_t n)
{
  const Model *m = &((Instance *)c)->model;
  Motion motion;
  if (n != (size_t)STATES)
    return wrong((Instance *)c, "fmi3GetContinuousStateDerivatives: not the number of states");
  model_rates(m, m->time, m->x, derivatives, &motion);
  return all_finite(derivatives, STATES) ? fmi3OK : fmi3Discard;
}

fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 indicators[], size_t n)
{
  const Model *m = &((Instance *)c)->model;
  if (n != (size_t)INDICATORS)
    return wrong((Instance *)c, "fmi3GetEventIndicators: not the number of indicators");
  if (n)
    model_indicators(m, m->time, m->x, indicators);
  return fmi3OK;
}

fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 x[], size_t n)
{
  if (n != (size_t)STATES)
    return wrong((Instance *)c, "fmi3GetContinuousStates: not the number of states");
  memcpy(x, ((Instance *)c)->model.x, n * sizeof(double));
  return fmi3OK;
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 nominals[], size_t n)
{
  if (n != (size_t)STATES)
    return wrong((Instance *)c, "fmi3GetNominalsOfContinuousStates: not the number of states");
  memcpy(nominals, NOMINAL, n * sizeof(double));
  return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *n)
{
  (void)c;
  *n = INDICATORS;
  return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *n)
{
  (void)c;
  *n = STATES;
  return fmi3OK;
}

/* Co-simulation. */

fmi3Status fmi3EnterStepMode(fmi3Instance c)
{
  ((Instance *)c)->model.doing = STEPPING;
  return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 from, fmi3Float64 length, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                      fmi3Boolean *eventHandlingNeeded, fmi3Boolean *terminate, fmi3Boolean *earlyReturn,
                      fmi3Float64 *lastSuccessfulTime)
{
  Instance *own = (Instance *)c;
  int done;
  (void)noSetFMUStatePriorToCurrentPoint;
  *eventHandlingNeeded = fmi3False;
  *terminate = fmi3False;
  *earlyReturn = fmi3False;
  *lastSuccessfulTime = own->model.time;
  if (!(length >= 0.0))
    return wrong(own, "fmi3DoStep: the step must not be negative");
  if (fabs(own->model.time - from) > 1e-9 * (1.0 + fabs(from)))
    return wrong(own, "fmi3DoStep: begins at another time than the step before it ended");
  own->model.doing = STEPPING;
  done = model_advance(&own->model, from + length);
  *lastSuccessfulTime = own->model.time;
  return done ? fmi3OK : wrong(own, "fmi3DoStep: no step is short enough for the tolerance");
}
