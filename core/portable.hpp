// Host and device: the only file that knows that a CUDA compiler exists.
#pragma once

#ifdef __CUDACC__
#define PM_HD __host__ __device__ inline
#else
#define PM_HD inline
#endif
