/* SPDX-License-Identifier: MIT
 * The functions of FMI 3.0, co-simulation, over fmu.h. What they need of the standard's headers
 * stands here, by the standard's text. */
#include <stdbool.h>
#include <stdint.h>

#include "fmu.h"

#pragma GCC diagnostic ignored "-Wunused-parameter" /* the standard says which there are */

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
  return FMU_OK;
}

FMI3 void *fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                       bool visible, bool logs, bool events, bool early,
                                       const fmi3ValueReference wanted[], size_t n_wanted,
                                       void *environment, fmi3Logger *logger, void *update) {
  const fmu like = {
      .log = tell, .environment = environment, .call = *(void **)&logger, .early = early};
  return fmu_new(name, token, resources, &like);
}

FMI3 void fmi3FreeInstance(void *c) {
  fmu_free(c);
}

FMI3 fmi3Status fmi3EnterInitializationMode(void *c, bool has_tolerance, double tolerance,
                                            double start_s, bool has_stop, double stop_s) {
  return fmu_set_up(c, start_s, has_stop, stop_s); /* run.tolerance stands in the scene */
}

FMI3 fmi3Status fmi3ExitInitializationMode(void *c) {
  return fmu_begin(c);
}

FMI3 fmi3Status fmi3DoStep(void *c, double at_s, double step_s, bool no_going_back, bool *events,
                           bool *ends, bool *early, double *last_s) {
  int stopped = 0;
  fmi3Status status = fmu_step(c, at_s, step_s, last_s, &stopped);
  *events = *ends = false;
  *early = stopped;
  return status;
}

FMI3 fmi3Status fmi3EnterStepMode(void *c) {
  return FMU_OK;
}

FMI3 fmi3Status fmi3Terminate(void *c) {
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
  return fmu_forget(state);
}

FMI3 fmi3Status fmi3SerializedFMUStateSize(void *c, void *state, size_t *size) {
  return fmu_size_of_state(c, state, size);
}

FMI3 fmi3Status fmi3SerializeFMUState(void *c, void *state, uint8_t byte[], size_t size) {
  return fmu_write_state(c, state, byte, size);
}

FMI3 fmi3Status fmi3DeserializeFMUState(void *c, const uint8_t byte[], size_t size, void **state) {
  return fmu_read_state(c, byte, size, state);
}

/* ---- what the description does not offer ----
 *
 * A master looks for all of the standard's functions. */

FMI3 void *fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                        bool visible, bool logs, void *environment,
                                        fmi3Logger *logger) {
  return NULL;
}

FMI3 void *fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token,
                                             fmi3String resources, bool visible, bool logs,
                                             void *environment, fmi3Logger *logger, void *update,
                                             void *lock, void *unlock) {
  return NULL;
}

/* The function of that name refuses; asked: how many things it is asked for. */
#define REFUSES(name, asked, arguments)                                                            \
  FMI3 fmi3Status fmi3##name arguments {                                                           \
    return (asked) ? fmu_say(c, FMU_ERROR, "this unit does not support fmi3" #name) : FMU_OK;      \
  }
#define NO_VARIABLES(type, value_type)                                                             \
  REFUSES(Get##type, n,                                                                            \
          (void *c, const fmi3ValueReference r[], size_t n, value_type value[], size_t values))    \
  REFUSES(                                                                                         \
      Set##type, n,                                                                                \
      (void *c, const fmi3ValueReference r[], size_t n, const value_type value[], size_t values))

NO_VARIABLES(Float32, float)
NO_VARIABLES(Int8, int8_t)
NO_VARIABLES(UInt8, uint8_t)
NO_VARIABLES(Int16, int16_t)
NO_VARIABLES(UInt16, uint16_t)
NO_VARIABLES(Int32, int32_t)
NO_VARIABLES(UInt32, uint32_t)
NO_VARIABLES(Int64, int64_t)
NO_VARIABLES(UInt64, uint64_t)
NO_VARIABLES(Boolean, bool)
NO_VARIABLES(String, fmi3String)
REFUSES(GetBinary, n,
        (void *c, const fmi3ValueReference r[], size_t n, size_t size[], const uint8_t *value[],
         size_t values))
REFUSES(SetBinary, n,
        (void *c, const fmi3ValueReference r[], size_t n, const size_t size[],
         const uint8_t *const value[], size_t values))
REFUSES(GetClock, n, (void *c, const fmi3ValueReference r[], size_t n, bool value[]))
REFUSES(SetClock, n, (void *c, const fmi3ValueReference r[], size_t n, const bool value[]))
REFUSES(GetNumberOfVariableDependencies, 1, (void *c, fmi3ValueReference of, size_t *count))
REFUSES(GetVariableDependencies, n,
        (void *c, fmi3ValueReference of, size_t element[], fmi3ValueReference on[],
         size_t elements[], int kind[], size_t n))
REFUSES(GetDirectionalDerivative, n,
        (void *c, const fmi3ValueReference z[], size_t n, const fmi3ValueReference v[], size_t n_v,
         const double seed[], size_t n_seed, double value[], size_t values))
REFUSES(GetAdjointDerivative, n,
        (void *c, const fmi3ValueReference z[], size_t n, const fmi3ValueReference v[], size_t n_v,
         const double seed[], size_t n_seed, double value[], size_t values))
REFUSES(EnterEventMode, 1, (void *c))
REFUSES(EnterConfigurationMode, 1, (void *c))
REFUSES(ExitConfigurationMode, 1, (void *c))
REFUSES(EvaluateDiscreteStates, 1, (void *c))
REFUSES(EnterContinuousTimeMode, 1, (void *c))
REFUSES(GetIntervalDecimal, n,
        (void *c, const fmi3ValueReference r[], size_t n, double value[], int kind[]))
REFUSES(GetIntervalFraction, n,
        (void *c, const fmi3ValueReference r[], size_t n, uint64_t count[], uint64_t resolution[],
         int kind[]))
REFUSES(GetShiftDecimal, n, (void *c, const fmi3ValueReference r[], size_t n, double value[]))
REFUSES(GetShiftFraction, n,
        (void *c, const fmi3ValueReference r[], size_t n, uint64_t count[], uint64_t resolution[]))
REFUSES(SetIntervalDecimal, n,
        (void *c, const fmi3ValueReference r[], size_t n, const double value[]))
REFUSES(SetIntervalFraction, n,
        (void *c, const fmi3ValueReference r[], size_t n, const uint64_t count[],
         const uint64_t resolution[]))
REFUSES(SetShiftDecimal, n, (void *c, const fmi3ValueReference r[], size_t n, const double value[]))
REFUSES(SetShiftFraction, n,
        (void *c, const fmi3ValueReference r[], size_t n, const uint64_t count[],
         const uint64_t resolution[]))
REFUSES(UpdateDiscreteStates, 1,
        (void *c, bool *again, bool *ends, bool *nominals, bool *values, bool *has_next,
         double *next_s))
REFUSES(CompletedIntegratorStep, 1, (void *c, bool no_going_back, bool *events, bool *ends))
REFUSES(SetTime, 1, (void *c, double t_s))
REFUSES(SetContinuousStates, n, (void *c, const double x[], size_t n))
REFUSES(GetContinuousStateDerivatives, n, (void *c, double x[], size_t n))
REFUSES(GetEventIndicators, n, (void *c, double x[], size_t n))
REFUSES(GetContinuousStates, n, (void *c, double x[], size_t n))
REFUSES(GetNominalsOfContinuousStates, n, (void *c, double x[], size_t n))
REFUSES(GetOutputDerivatives, n,
        (void *c, const fmi3ValueReference r[], size_t n, const int32_t order[], double value[],
         size_t values))
REFUSES(ActivateModelPartition, 1, (void *c, fmi3ValueReference clock, double at_s))

/* There are none of these. */
FMI3 fmi3Status fmi3GetNumberOfEventIndicators(void *c, size_t *count) {
  *count = 0;
  return FMU_OK;
}

FMI3 fmi3Status fmi3GetNumberOfContinuousStates(void *c, size_t *count) {
  *count = 0;
  return FMU_OK;
}
