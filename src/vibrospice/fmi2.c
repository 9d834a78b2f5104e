/* SPDX-License-Identifier: MIT
 * The functions of FMI 2.0, co-simulation, over fmu.h. What they need of the standard's headers
 * stands here, by the standard's text. */
#include "fmu.h"

#pragma GCC diagnostic ignored "-Wunused-parameter" /* the standard says which there are */

typedef int fmi2Status;
typedef unsigned fmi2ValueReference;
typedef const char *fmi2String;
typedef void fmi2Logger(void *environment, fmi2String instance, fmi2Status status,
                        fmi2String category, fmi2String message, ...);
typedef struct {
  fmi2Logger *logger;
  void *(*allocate)(size_t count, size_t size);
  void (*release)(void *memory);
  void (*finished)(void *environment, fmi2Status status);
  void *environment;
} fmi2CallbackFunctions;

#define FMI2 VIBROSPICE_API

static void tell(const fmu *u, int status, const char *text) {
  fmi2Logger *logger = *(fmi2Logger *const *)u->call;
  if (logger)
    logger(u->environment, u->name, status,
           status == FMU_FATAL ? "logStatusFatal" : "logStatusError", "%s", text);
}

FMI2 const char *fmi2GetTypesPlatform(void) {
  return "default";
}

FMI2 const char *fmi2GetVersion(void) {
  return "2.0";
}

FMI2 fmi2Status fmi2SetDebugLogging(void *c, int on, size_t n, const fmi2String category[]) {
  return FMU_OK;
}

FMI2 void fmi2FreeInstance(void *c) {
  fmu_free(c);
}

/* The callbacks outlive the instance, as the standard says. type 1: co-simulation. */
FMI2 void *fmi2Instantiate(fmi2String name, int type, fmi2String guid, fmi2String resources,
                           const fmi2CallbackFunctions *call, int visible, int logs) {
  if (!call || type != 1) return NULL;
  const fmu like = {
      .log = tell, .environment = call->environment, .call = (void *)(size_t)&call->logger};
  return fmu_new(name, guid, resources, &like);
}

FMI2 fmi2Status fmi2SetupExperiment(void *c, int has_tolerance, double tolerance, double start_s,
                                    int has_stop, double stop_s) {
  return fmu_set_up(c, start_s, has_stop, stop_s); /* run.tolerance stands in the scene */
}

FMI2 fmi2Status fmi2EnterInitializationMode(void *c) {
  return FMU_OK;
}

FMI2 fmi2Status fmi2ExitInitializationMode(void *c) {
  return fmu_begin(c);
}

FMI2 fmi2Status fmi2DoStep(void *c, double at_s, double step_s, int no_going_back) {
  return fmu_step(c, at_s, step_s, NULL, NULL);
}

FMI2 fmi2Status fmi2CancelStep(void *c) {
  return fmu_say(c, FMU_ERROR, "a step cannot be cancelled: it is done when the call returns");
}

FMI2 fmi2Status fmi2Terminate(void *c) {
  return FMU_OK;
}

FMI2 fmi2Status fmi2Reset(void *c) {
  return fmu_reset(c);
}

FMI2 fmi2Status fmi2GetReal(void *c, const fmi2ValueReference r[], size_t n, double value[]) {
  return fmu_get(c, r, n, value);
}

FMI2 fmi2Status fmi2SetReal(void *c, const fmi2ValueReference r[], size_t n, const double value[]) {
  return fmu_set(c, r, n, value);
}

FMI2 fmi2Status fmi2GetFMUstate(void *c, void **state) {
  return fmu_save(c, state);
}

FMI2 fmi2Status fmi2SetFMUstate(void *c, void *state) {
  return fmu_restore(c, state);
}

FMI2 fmi2Status fmi2FreeFMUstate(void *c, void **state) {
  return fmu_forget(state);
}

FMI2 fmi2Status fmi2SerializedFMUstateSize(void *c, void *state, size_t *size) {
  return fmu_size_of_state(c, state, size);
}

FMI2 fmi2Status fmi2SerializeFMUstate(void *c, void *state, char bytes[], size_t size) {
  return fmu_write_state(c, state, bytes, size);
}

FMI2 fmi2Status fmi2DeSerializeFMUstate(void *c, const char bytes[], size_t size, void **state) {
  return fmu_read_state(c, bytes, size, state);
}

/* ---- what the description does not offer ----
 *
 * A master looks for all of the standard's functions. */

/* The function of that name refuses; asked: how many things it is asked for. */
#define REFUSES(name, asked, arguments)                                                            \
  FMI2 fmi2Status fmi2##name arguments {                                                           \
    return (asked) ? fmu_say(c, FMU_ERROR, "this unit does not support fmi2" #name) : FMU_OK;      \
  }
#define NO_VARIABLES(type, value_type)                                                             \
  REFUSES(Get##type, n, (void *c, const fmi2ValueReference r[], size_t n, value_type value[]))     \
  REFUSES(Set##type, n, (void *c, const fmi2ValueReference r[], size_t n, const value_type value[]))

NO_VARIABLES(Integer, int)
NO_VARIABLES(Boolean, int)
NO_VARIABLES(String, fmi2String)
REFUSES(GetDirectionalDerivative, n,
        (void *c, const fmi2ValueReference z[], size_t n, const fmi2ValueReference v[], size_t n_v,
         const double dv[], double dz[]))
REFUSES(SetRealInputDerivatives, n,
        (void *c, const fmi2ValueReference r[], size_t n, const int order[], const double value[]))
REFUSES(GetRealOutputDerivatives, n,
        (void *c, const fmi2ValueReference r[], size_t n, const int order[], double value[]))

FMI2 fmi2Status fmi2GetStatus(void *c, int kind, fmi2Status *value) {
  return FMU_DISCARD;
}

FMI2 fmi2Status fmi2GetIntegerStatus(void *c, int kind, int *value) {
  return FMU_DISCARD;
}

FMI2 fmi2Status fmi2GetBooleanStatus(void *c, int kind, int *value) {
  return FMU_DISCARD;
}

FMI2 fmi2Status fmi2GetStringStatus(void *c, int kind, fmi2String *value) {
  return FMU_DISCARD;
}

/* Kind 2 is the last successful time. */
FMI2 fmi2Status fmi2GetRealStatus(void *c, int kind, double *value) {
  const unsigned time = 0;
  return kind == 2 ? fmu_get(c, &time, 1, value) : FMU_DISCARD;
}
