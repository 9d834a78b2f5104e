/* SPDX-License-Identifier: MIT
 * The functions of FMI 3.0, co-simulation, over fmu.h. What they need of the standard's headers
 * stands here, by the standard's text. */
#include <stdbool.h>
#include <stdint.h>

#include "fmu.h"

typedef int fmi3Status;
typedef unsigned fmi3ValueReference;
typedef const char *fmi3String;
typedef void fmi3Logger(void *environment, fmi3Status status, fmi3String category,
                        fmi3String message);

#define FMI3 VIBROSPICE_API

static void tell(const fmu *u, int status, const char *text) {
  fmi3Logger *logger;
  *(void **)&logger = u->call;
  if (logger)
    logger(u->environment, status, status == FMU_FATAL ? "logStatusFatal" : "logStatusError", text);
}

FMI3 const char *fmi3GetVersion(void) {
  return "3.0";
}

FMI3 fmi3Status fmi3SetDebugLogging(void *c, bool on, size_t n, const fmi3String category[]) {
  (void)c, (void)on, (void)n, (void)category;
  return FMU_OK;
}

FMI3 void *fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                       bool visible, bool logs, bool events, bool early,
                                       const fmi3ValueReference wanted[], size_t n_wanted,
                                       void *environment, fmi3Logger *logger, void *update) {
  (void)token, (void)visible, (void)logs, (void)events, (void)early;
  (void)wanted, (void)n_wanted, (void)update;
  const fmu like = {.log = tell, .environment = environment, .call = *(void **)&logger};
  return fmu_new(name, resources, &like);
}

FMI3 void fmi3FreeInstance(void *c) {
  fmu_free(c);
}

FMI3 fmi3Status fmi3EnterInitializationMode(void *c, bool has_tolerance, double tolerance,
                                            double start_s, bool has_stop, double stop_s) {
  fmu *u = c;
  (void)has_tolerance, (void)tolerance; /* run.tolerance stands in the scene */
  if (start_s != 0) return fmu_say(u, FMU_ERROR, "the run begins at 0 s: startTime = 0");
  if (has_stop) u->stop_s = stop_s;
  return FMU_OK;
}

FMI3 fmi3Status fmi3ExitInitializationMode(void *c) {
  return fmu_begin(c);
}

FMI3 fmi3Status fmi3DoStep(void *c, double at_s, double step_s, bool no_going_back, bool *events,
                           bool *ends, bool *early, double *last_s) {
  const fmi3ValueReference time = 0;
  (void)no_going_back;
  fmi3Status status = fmu_step(c, at_s, step_s);
  *events = *ends = *early = false;
  const fmi3Status told = fmu_get(c, &time, 1, last_s);
  return status ? status : told;
}

FMI3 fmi3Status fmi3EnterStepMode(void *c) {
  (void)c;
  return FMU_OK;
}

FMI3 fmi3Status fmi3Terminate(void *c) {
  (void)c;
  return FMU_OK;
}

FMI3 fmi3Status fmi3Reset(void *c) {
  return fmu_reset(c);
}

FMI3 fmi3Status fmi3GetFloat64(void *c, const fmi3ValueReference r[], size_t n, double value[],
                               size_t values) {
  return values == n ? fmu_get(c, r, n, value)
                     : fmu_say(c, FMU_ERROR, "each variable has one value");
}

FMI3 fmi3Status fmi3SetFloat64(void *c, const fmi3ValueReference r[], size_t n,
                               const double value[], size_t values) {
  return values == n ? fmu_set(c, r, n, value)
                     : fmu_say(c, FMU_ERROR, "each variable has one value");
}

FMI3 fmi3Status fmi3GetFMUState(void *c, void **state) {
  return fmu_save(c, state);
}

FMI3 fmi3Status fmi3SetFMUState(void *c, void *state) {
  return fmu_restore(c, state);
}

FMI3 fmi3Status fmi3FreeFMUState(void *c, void **state) {
  (void)c;
  return fmu_forget(state);
}

/* ---- what the description does not offer ----
 *
 * A master looks for all of the standard's functions. */

FMI3 void *fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                        bool visible, bool logs, void *environment,
                                        fmi3Logger *logger) {
  (void)name, (void)token, (void)resources, (void)visible, (void)logs, (void)environment;
  (void)logger;
  return NULL;
}

FMI3 void *fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token,
                                             fmi3String resources, bool visible, bool logs,
                                             void *environment, fmi3Logger *logger, void *update,
                                             void *lock, void *unlock) {
  (void)name, (void)token, (void)resources, (void)visible, (void)logs, (void)environment;
  (void)logger, (void)update, (void)lock, (void)unlock;
  return NULL;
}

static fmi3Status refuse(const fmu *u, size_t asked) {
  return asked ? fmu_say(u, FMU_ERROR, "this unit has no such thing") : FMU_OK;
}

FMI3 fmi3Status fmi3GetFloat32(void *c, const fmi3ValueReference r[], size_t n, float value[],
                               size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetFloat32(void *c, const fmi3ValueReference r[], size_t n, const float value[],
                               size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetInt8(void *c, const fmi3ValueReference r[], size_t n, int8_t value[],
                            size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetInt8(void *c, const fmi3ValueReference r[], size_t n, const int8_t value[],
                            size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetUInt8(void *c, const fmi3ValueReference r[], size_t n, uint8_t value[],
                             size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetUInt8(void *c, const fmi3ValueReference r[], size_t n, const uint8_t value[],
                             size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetInt16(void *c, const fmi3ValueReference r[], size_t n, int16_t value[],
                             size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetInt16(void *c, const fmi3ValueReference r[], size_t n, const int16_t value[],
                             size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetUInt16(void *c, const fmi3ValueReference r[], size_t n, uint16_t value[],
                              size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetUInt16(void *c, const fmi3ValueReference r[], size_t n,
                              const uint16_t value[], size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetInt32(void *c, const fmi3ValueReference r[], size_t n, int32_t value[],
                             size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetInt32(void *c, const fmi3ValueReference r[], size_t n, const int32_t value[],
                             size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetUInt32(void *c, const fmi3ValueReference r[], size_t n, uint32_t value[],
                              size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetUInt32(void *c, const fmi3ValueReference r[], size_t n,
                              const uint32_t value[], size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetInt64(void *c, const fmi3ValueReference r[], size_t n, int64_t value[],
                             size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetInt64(void *c, const fmi3ValueReference r[], size_t n, const int64_t value[],
                             size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetUInt64(void *c, const fmi3ValueReference r[], size_t n, uint64_t value[],
                              size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetUInt64(void *c, const fmi3ValueReference r[], size_t n,
                              const uint64_t value[], size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetBoolean(void *c, const fmi3ValueReference r[], size_t n, bool value[],
                               size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetBoolean(void *c, const fmi3ValueReference r[], size_t n, const bool value[],
                               size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetString(void *c, const fmi3ValueReference r[], size_t n, fmi3String value[],
                              size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetString(void *c, const fmi3ValueReference r[], size_t n,
                              const fmi3String value[], size_t values) {
  (void)r, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetBinary(void *c, const fmi3ValueReference r[], size_t n, size_t size[],
                              const uint8_t *value[], size_t values) {
  (void)r, (void)size, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetBinary(void *c, const fmi3ValueReference r[], size_t n, const size_t size[],
                              const uint8_t *const value[], size_t values) {
  (void)r, (void)size, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetClock(void *c, const fmi3ValueReference r[], size_t n, bool value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetClock(void *c, const fmi3ValueReference r[], size_t n, const bool value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetNumberOfVariableDependencies(void *c, fmi3ValueReference of, size_t *count) {
  (void)of, (void)count;
  return refuse(c, 1);
}

FMI3 fmi3Status fmi3GetVariableDependencies(void *c, fmi3ValueReference of, size_t element[],
                                            fmi3ValueReference on[], size_t elements[], int kind[],
                                            size_t n) {
  (void)of, (void)element, (void)on, (void)elements, (void)kind;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SerializedFMUStateSize(void *c, void *state, size_t *size) {
  (void)state, (void)size;
  return refuse(c, 1);
}

FMI3 fmi3Status fmi3SerializeFMUState(void *c, void *state, uint8_t byte[], size_t size) {
  (void)state, (void)byte, (void)size;
  return refuse(c, 1);
}

FMI3 fmi3Status fmi3DeserializeFMUState(void *c, const uint8_t byte[], size_t size, void **state) {
  (void)byte, (void)size, (void)state;
  return refuse(c, 1);
}

FMI3 fmi3Status fmi3GetDirectionalDerivative(void *c, const fmi3ValueReference z[], size_t n,
                                             const fmi3ValueReference v[], size_t n_v,
                                             const double seed[], size_t n_seed, double value[],
                                             size_t values) {
  (void)z, (void)v, (void)n_v, (void)seed, (void)n_seed, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetAdjointDerivative(void *c, const fmi3ValueReference z[], size_t n,
                                         const fmi3ValueReference v[], size_t n_v,
                                         const double seed[], size_t n_seed, double value[],
                                         size_t values) {
  (void)z, (void)v, (void)n_v, (void)seed, (void)n_seed, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3EnterEventMode(void *c) {
  return refuse(c, 1);
}

FMI3 fmi3Status fmi3EnterConfigurationMode(void *c) {
  return refuse(c, 1);
}

FMI3 fmi3Status fmi3ExitConfigurationMode(void *c) {
  return refuse(c, 1);
}

FMI3 fmi3Status fmi3EvaluateDiscreteStates(void *c) {
  return refuse(c, 1);
}

FMI3 fmi3Status fmi3EnterContinuousTimeMode(void *c) {
  return refuse(c, 1);
}

FMI3 fmi3Status fmi3GetIntervalDecimal(void *c, const fmi3ValueReference r[], size_t n,
                                       double value[], int kind[]) {
  (void)r, (void)value, (void)kind;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetIntervalFraction(void *c, const fmi3ValueReference r[], size_t n,
                                        uint64_t count[], uint64_t resolution[], int kind[]) {
  (void)r, (void)count, (void)resolution, (void)kind;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetShiftDecimal(void *c, const fmi3ValueReference r[], size_t n,
                                    double value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetShiftFraction(void *c, const fmi3ValueReference r[], size_t n,
                                     uint64_t count[], uint64_t resolution[]) {
  (void)r, (void)count, (void)resolution;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetIntervalDecimal(void *c, const fmi3ValueReference r[], size_t n,
                                       const double value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetIntervalFraction(void *c, const fmi3ValueReference r[], size_t n,
                                        const uint64_t count[], const uint64_t resolution[]) {
  (void)r, (void)count, (void)resolution;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetShiftDecimal(void *c, const fmi3ValueReference r[], size_t n,
                                    const double value[]) {
  (void)r, (void)value;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3SetShiftFraction(void *c, const fmi3ValueReference r[], size_t n,
                                     const uint64_t count[], const uint64_t resolution[]) {
  (void)r, (void)count, (void)resolution;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3UpdateDiscreteStates(void *c, bool *again, bool *ends, bool *nominals,
                                         bool *values, bool *has_next, double *next_s) {
  (void)again, (void)ends, (void)nominals, (void)values, (void)has_next, (void)next_s;
  return refuse(c, 1);
}

FMI3 fmi3Status fmi3CompletedIntegratorStep(void *c, bool no_going_back, bool *events, bool *ends) {
  (void)no_going_back, (void)events, (void)ends;
  return refuse(c, 1);
}

FMI3 fmi3Status fmi3SetTime(void *c, double t_s) {
  (void)t_s;
  return refuse(c, 1);
}

FMI3 fmi3Status fmi3SetContinuousStates(void *c, const double x[], size_t n) {
  (void)x;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetContinuousStateDerivatives(void *c, double x[], size_t n) {
  (void)x;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetEventIndicators(void *c, double x[], size_t n) {
  (void)x;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetContinuousStates(void *c, double x[], size_t n) {
  (void)x;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetNominalsOfContinuousStates(void *c, double x[], size_t n) {
  (void)x;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3GetOutputDerivatives(void *c, const fmi3ValueReference r[], size_t n,
                                         const int32_t order[], double value[], size_t values) {
  (void)r, (void)order, (void)value, (void)values;
  return refuse(c, n);
}

FMI3 fmi3Status fmi3ActivateModelPartition(void *c, fmi3ValueReference clock, double at_s) {
  (void)clock, (void)at_s;
  return refuse(c, 1);
}

/* There are none, which is an answer. */
FMI3 fmi3Status fmi3GetNumberOfEventIndicators(void *c, size_t *count) {
  (void)c;
  *count = 0;
  return FMU_OK;
}

FMI3 fmi3Status fmi3GetNumberOfContinuousStates(void *c, size_t *count) {
  (void)c;
  *count = 0;
  return FMU_OK;
}
