// Host and device: the only file that knows which compiler it is.
#pragma once

// The laws are called once a point a step: always inlined, so that a point's state stays in registers.
#ifdef __CUDACC__
#define PM_HD __host__ __device__ __forceinline__
#else
#define PM_HD inline __attribute__((always_inline))
#endif
