/* SPDX-License-Identifier: MIT
 * The functions of FMI 2.0, co-simulation, over fmu.h. What they need of the standard's headers
 * stands here, by the standard's text. */
#include "fmu.h"

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
  (void)c, (void)on, (void)n, (void)category;
  return FMU_OK;
}

FMI2 void fmi2FreeInstance(void *c) {
  fmu_free(c);
}

/* The callbacks outlive the instance, as the standard says. type 1: co-simulation. */
FMI2 void *fmi2Instantiate(fmi2String name, int type, fmi2String guid, fmi2String resources,
                           const fmi2CallbackFunctions *call, int visible, int logs) {
  (void)guid, (void)visible, (void)logs;
  if (!call || type != 1) return NULL;
  const fmu like = {
      .log = tell, .environment = call->environment, .call = (void *)(size_t)&call->logger};
  return fmu_new(name, resources, &like);
}

FMI2 fmi2Status fmi2SetupExperiment(void *c, int has_tolerance, double tolerance, double start_s,
                                    int has_stop, double stop_s) {
  fmu *u = c;
  (void)has_tolerance, (void)tolerance; /* run.tolerance stands in the scene */
  if (start_s != 0) return fmu_say(u, FMU_ERROR, "the run begins at 0 s: startTime = 0");
  if (has_stop) u->stop_s = stop_s;
  return FMU_OK;
}

FMI2 fmi2Status fmi2EnterInitializationMode(void *c) {
  (void)c;
  return FMU_OK;
}

FMI2 fmi2Status fmi2ExitInitializationMode(void *c) {
  return fmu_begin(c);
}

FMI2 fmi2Status fmi2DoStep(void *c, double at_s, double step_s, int no_going_back) {
  (void)no_going_back;
  return fmu_step(c, at_s, step_s);
}

FMI2 fmi2Status fmi2CancelStep(void *c) {
  return fmu_say(c, FMU_ERROR, "a step is done when the call returns");
}

FMI2 fmi2Status fmi2Terminate(void *c) {
  (void)c;
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
  (void)c;
  return fmu_forget(state);
}

/* ---- what the description does not offer ----
 *
 * A master looks for all of the standard's functions. */

static fmi2Status refuse(const fmu *u, size_t asked) {
  return asked ? fmu_say(u, FMU_ERROR, "this unit has no such thing") : FMU_OK;
}

FMI2 fmi2Status fmi2GetInteger(void *c, const fmi2ValueReference r[], size_t n, int value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI2 fmi2Status fmi2SetInteger(void *c, const fmi2ValueReference r[], size_t n, const int value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI2 fmi2Status fmi2GetBoolean(void *c, const fmi2ValueReference r[], size_t n, int value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI2 fmi2Status fmi2SetBoolean(void *c, const fmi2ValueReference r[], size_t n, const int value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI2 fmi2Status fmi2GetString(void *c, const fmi2ValueReference r[], size_t n, fmi2String value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI2 fmi2Status fmi2SetString(void *c, const fmi2ValueReference r[], size_t n,
                              const fmi2String value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI2 fmi2Status fmi2SerializedFMUstateSize(void *c, void *state, size_t *size) {
  (void)state, (void)size;
  return refuse(c, 1);
}

FMI2 fmi2Status fmi2SerializeFMUstate(void *c, void *state, char bytes[], size_t size) {
  (void)state, (void)bytes, (void)size;
  return refuse(c, 1);
}

FMI2 fmi2Status fmi2DeSerializeFMUstate(void *c, const char bytes[], size_t size, void **state) {
  (void)bytes, (void)size, (void)state;
  return refuse(c, 1);
}

FMI2 fmi2Status fmi2GetDirectionalDerivative(void *c, const fmi2ValueReference z[], size_t n_z,
                                             const fmi2ValueReference v[], size_t n_v,
                                             const double dv[], double dz[]) {
  (void)z, (void)v, (void)n_v, (void)dv, (void)dz;
  return refuse(c, n_z);
}

FMI2 fmi2Status fmi2SetRealInputDerivatives(void *c, const fmi2ValueReference r[], size_t n,
                                            const int order[], const double value[]) {
  (void)r, (void)order, (void)value;
  return refuse(c, n);
}

FMI2 fmi2Status fmi2GetRealOutputDerivatives(void *c, const fmi2ValueReference r[], size_t n,
                                             const int order[], double value[]) {
  (void)r, (void)order, (void)value;
  return refuse(c, n);
}

FMI2 fmi2Status fmi2GetStatus(void *c, int kind, fmi2Status *value) {
  (void)c, (void)kind, (void)value;
  return FMU_DISCARD;
}

FMI2 fmi2Status fmi2GetIntegerStatus(void *c, int kind, int *value) {
  (void)c, (void)kind, (void)value;
  return FMU_DISCARD;
}

FMI2 fmi2Status fmi2GetBooleanStatus(void *c, int kind, int *value) {
  (void)c, (void)kind, (void)value;
  return FMU_DISCARD;
}

FMI2 fmi2Status fmi2GetStringStatus(void *c, int kind, fmi2String *value) {
  (void)c, (void)kind, (void)value;
  return FMU_DISCARD;
}

/* Kind 2 is the last successful time. */
FMI2 fmi2Status fmi2GetRealStatus(void *c, int kind, double *value) {
  const unsigned time = 0;
  return kind == 2 ? fmu_get(c, &time, 1, value) : FMU_DISCARD;
}
