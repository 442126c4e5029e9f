
/* The functions of FMI 2.0, for model exchange and co-simulation. */
#include "fmi2Functions.h"

typedef struct {
  Model model;
  const fmi2CallbackFunctions *call;
  char *name;
  int logging;
} Instance;

static void *room(const fmi2CallbackFunctions *call, size_t size)
{
  return call && call->allocateMemory ? call->allocateMemory(1, size) : calloc(1, size);
}

static void leave(const fmi2CallbackFunctions *call, void *what)
{
  if (call && call->freeMemory)
    call->freeMemory(what);
  else
    free(what);
}

static fmi2Status wrong(const Instance *c, const char *message)
{
  if (c->logging && c->call && c->call->logger)
    c->call->logger(c->call->componentEnvironment, c->name, fmi2Error, "logStatusError", "%s", message);
  return fmi2Error;
}

const char *fmi2GetTypesPlatform(void)
{
  return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
  return fmi2Version;
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
  (void)n;
  (void)categories;
  ((Instance *)c)->logging = on;
  return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *call, fmi2Boolean visible, fmi2Boolean logging)
{
  Instance *c;
  (void)type;
  (void)resources;
  (void)visible;
  if (!guid || strcmp(guid, MODEL_TOKEN) != 0) {
    if (call && call->logger)
      call->logger(call->componentEnvironment, name, fmi2Error, "logStatusError", "%s",
                   "the GUID is not that of these sources");
    return 0;
  }
  c = (Instance *)room(call, sizeof(Instance));
  if (!c)
    return 0;
  c->name = (char *)room(call, name ? strlen(name) + 1 : 1);
  if (!c->name) {
    leave(call, c);
    return 0;
  }
  if (name)
    strcpy(c->name, name);
  c->call = call;
  c->logging = logging;
  model_reset(&c->model);
  return c;
}

void fmi2FreeInstance(fmi2Component c)
{
  Instance *own = (Instance *)c;
  const fmi2CallbackFunctions *call;
  if (!own)
    return;
  call = own->call;
  leave(call, own->name);
  leave(call, own);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
                               fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
  Model *m = &((Instance *)c)->model;
  (void)stopTimeDefined;
  (void)stopTime;
  m->time = startTime;
  if (toleranceDefined && tolerance > 0.0)
    m->tolerance = tolerance;
  return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
  ((Instance *)c)->model.doing = INITIALIZING;
  return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
  Model *m = &((Instance *)c)->model;
  model_locate(m);
  m->doing = EVENTS;
  return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
  ((Instance *)c)->model.doing = DONE;
  return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
  model_reset(&((Instance *)c)->model);
  return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[])
{
  Instance *own = (Instance *)c;
  size_t i;
  if (own->model.doing <= INITIALIZING)
    model_locate(&own->model);
  for (i = 0; i < n; i++)
    if (!model_get(&own->model, vr[i], value + i))
      return wrong(own, "fmi2GetReal: there is no such variable");
  return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[])
{
  Instance *own = (Instance *)c;
  size_t i;
  for (i = 0; i < n; i++)
    if (!model_set(&own->model, vr[i], value[i]))
      return wrong(own, "fmi2SetReal: no variable that can be set now, or not a finite value");
  return fmi2OK;
}

/* There are no variables of other types. */
#define NONE(c, n, what) ((n) ? wrong((const Instance *)(c), what ": there are no variables of this type") : fmi2OK)

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Integer value[])
{
  (void)vr;
  (void)value;
  return NONE(c, n, "fmi2GetInteger");
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Boolean value[])
{
  (void)vr;
  (void)value;
  return NONE(c, n, "fmi2GetBoolean");
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[])
{
  (void)vr;
  (void)value;
  return NONE(c, n, "fmi2GetString");
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer value[])
{
  (void)vr;
  (void)value;
  return NONE(c, n, "fmi2SetInteger");
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Boolean value[])
{
  (void)vr;
  (void)value;
  return NONE(c, n, "fmi2SetBoolean");
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String value[])
{
  (void)vr;
  (void)value;
  return NONE(c, n, "fmi2SetString");
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
  Instance *own = (Instance *)c;
  if (!*state)
    *state = room(own->call, sizeof(Model));
  if (!*state)
    return wrong(own, "fmi2GetFMUstate: no memory is left");
  memcpy(*state, &own->model, sizeof(Model));
  return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
  memcpy(&((Instance *)c)->model, state, sizeof(Model));
  return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
  if (*state)
    leave(((Instance *)c)->call, *state);
  *state = 0;
  return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
  (void)c;
  (void)state;
  *size = sizeof(Model);
  return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
  if (size < sizeof(Model))
    return wrong((Instance *)c, "fmi2SerializeFMUstate: too few bytes");
  memcpy(bytes, state, sizeof(Model));
  return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
  Instance *own = (Instance *)c;
  if (size != sizeof(Model))
    return wrong(own, "fmi2DeSerializeFMUstate: not the bytes of such a state");
  if (!*state)
    *state = room(own->call, sizeof(Model));
  if (!*state)
    return wrong(own, "fmi2DeSerializeFMUstate: no memory is left");
  memcpy(*state, bytes, sizeof(Model));
  return fmi2OK;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                        const fmi2ValueReference known[], size_t knowns, const fmi2Real seed[],
                                        fmi2Real derivative[])
{
  (void)unknown;
  (void)unknowns;
  (void)known;
  (void)knowns;
  (void)seed;
  (void)derivative;
  return wrong((Instance *)c, "fmi2GetDirectionalDerivative: is not provided");
}

/* Model exchange. */

fmi2Status fmi2EnterEventMode(fmi2Component c)
{
  ((Instance *)c)->model.doing = EVENTS;
  return fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
  model_switch(&((Instance *)c)->model);
  info->newDiscreteStatesNeeded = fmi2False;
  info->terminateSimulation = fmi2False;
  info->nominalsOfContinuousStatesChanged = fmi2False;
  info->valuesOfContinuousStatesChanged = fmi2False;
  info->nextEventTimeDefined = fmi2False;
  info->nextEventTime = 0.0;
  return fmi2OK;
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c)
{
  ((Instance *)c)->model.doing = CONTINUOUS;
  return fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation)
{
  (void)c;
  (void)noSetFMUStatePriorToCurrentPoint;
  *enterEventMode = fmi2False;
  *terminateSimulation = fmi2False;
  return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time)
{
  ((Instance *)c)->model.time = time;
  return fmi2OK;
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t n)
{
  if (n != (size_t)STATES)
    return wrong((Instance *)c, "fmi2SetContinuousStates: not the number of states");
  memcpy(((Instance *)c)->model.x, x, n * sizeof(double));
  return fmi2OK;
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t n)
{
  const Model *m = &((Instance *)c)->model;
  Motion motion;
  if (n != (size_t)STATES)
    return wrong((Instance *)c, "fmi2GetDerivatives: not the number of states");
  model_rates(m, m->time, m->x, derivatives, &motion);
  return all_finite(derivatives, STATES) ? fmi2OK : fmi2Discard;
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real indicators[], size_t n)
{
  const Model *m = &((Instance *)c)->model;
  if (n != (size_t)INDICATORS)
    return wrong((Instance *)c, "fmi2GetEventIndicators: not the number of indicators");
  if (n)
    model_indicators(m, m->time, m->x, indicators);
  return fmi2OK;
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t n)
{
  if (n != (size_t)STATES)
    return wrong((Instance *)c, "fmi2GetContinuousStates: not the number of states");
  memcpy(x, ((Instance *)c)->model.x, n * sizeof(double));
  return fmi2OK;
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real nominals[], size_t n)
{
  if (n != (size_t)STATES)
    return wrong((Instance *)c, "fmi2GetNominalsOfContinuousStates: not the number of states");
  memcpy(nominals, NOMINAL, n * sizeof(double));
  return fmi2OK;
}

/* Co-simulation. */

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const fmi2Integer order[], const fmi2Real value[])
{
  (void)vr;
  (void)n;
  (void)order;
  (void)value;
  return wrong((Instance *)c, "fmi2SetRealInputDerivatives: inputs are constant within a step");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                        const fmi2Integer order[], fmi2Real value[])
{
  (void)vr;
  (void)n;
  (void)order;
  (void)value;
  return wrong((Instance *)c, "fmi2GetRealOutputDerivatives: are not provided");
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real from, fmi2Real length, fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
  Instance *own = (Instance *)c;
  (void)noSetFMUStatePriorToCurrentPoint;
  if (!(length >= 0.0))
    return wrong(own, "fmi2DoStep: the step must not be negative");
  own->model.doing = STEPPING;
  if (fabs(own->model.time - from) > 1e-9 * (1.0 + fabs(from)))
    return wrong(own, "fmi2DoStep: begins at another time than the step before it ended");
  if (!model_advance(&own->model, from + length))
    return wrong(own, "fmi2DoStep: no step is short enough for the tolerance");
  return fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
  return wrong((Instance *)c, "fmi2CancelStep: a step runs to its end");
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
  (void)kind;
  (void)value;
  return wrong((Instance *)c, "fmi2GetStatus: a step runs to its end");
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
  if (kind != fmi2LastSuccessfulTime)
    return wrong((Instance *)c, "fmi2GetRealStatus: no such status");
  *value = ((Instance *)c)->model.time;
  return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
  (void)kind;
  (void)value;
  return wrong((Instance *)c, "fmi2GetIntegerStatus: no such status");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
  if (kind != fmi2Terminated)
    return wrong((Instance *)c, "fmi2GetBooleanStatus: no such status");
  *value = fmi2False;
  return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
  (void)kind;
  (void)value;
  return wrong((Instance *)c, "fmi2GetStringStatus: no such status");
}
