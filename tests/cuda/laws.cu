// The laws of the CPU's headers on a GPU: elementary functions and the stress update of random points,
// computed on both. Prints the largest relative difference of each quantity, and the points that a GPU
// updates a second.
#include <cuda_runtime.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "../../core/constitutive.hpp"

using namespace pockmark;

namespace {

void require(cudaError_t status) {
  if (status == cudaSuccess) return;
  std::fprintf(stderr, "%s\n", cudaGetErrorString(status));
  std::exit(1);
}

template <class T>
struct Case {
  PointState<T> point;
  Sym3<T> strain;
  Vec3<T> half_turn;
};

// What a point's update leaves: its state, fast_log, fast_exp and fast_pow of its temperature, the squared
// sound speed.
template <class T>
struct Result {
  PointState<T> point;
  T log, exp, pow, c2;
};

MaterialSpec al2024() {
  return {
      {"mie-gruneisen", Constants({{"c0", 5330}, {"s", 1.34}, {"gamma0", 2}})},
      {"johnson-cook",
       Constants(
           {{"shear_modulus", 27.44e9}, {"A", 265e6}, {"B", 426e6}, {"n", 0.34}, {"C", 0.015}, {"m", 1}})},
      {"johnson-cook",
       Constants({{"treatment", 0}, {"D1", -0.77}, {"D2", 1.45}, {"D3", -0.47}, {"D5", 1.6}})},
      2770,
      875,
      1,
      293,
      775,
      1.5,
      0.06,
  };
}

template <class T>
PM_HD Result<T> updated(const Material<T>& material, Case<T> given) {
  const T cell = T(4e-6), dt = T(2e-10), volume = T(8e-18);
  const StressUpdate<T> update{material, cell, dt, dt, T(0.5), T(0.5)};
  auto& point = given.point;
  Tally<T> tally;
  T increment = 0;
  const Strain<T> strain(given.strain, given.half_turn);
  if (update.strain(point, strain, true, tally)) {
    const T trial = effective(point.deviator);
    const auto back = material.return_map(trial, point.plastic_strain, conditions_of(point), dt);
    increment = update.yield(point, trial, back, volume, true, tally);
  }
  const T c2 = update.press(point, strain.small, volume, true, tally);
  if (increment > T(0)) update.damage(point, increment, strain.small, true, tally);
  const T t = point.temperature / T(775);
  return {point, fast_log(t), fast_exp(-t), fast_pow(t, T(0.34)), c2};
}

template <class T>
__global__ void update_all(Material<T> material, const Case<T>* given, Result<T>* out, int n) {
  const int i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < n) out[i] = updated(material, given[i]);
}

template <class T>
std::vector<Case<T>> random_cases(int n) {
  std::mt19937 engine(7);
  const auto uniform = [&](double a, double b) { return T(std::uniform_real_distribution(a, b)(engine)); };
  std::vector<Case<T>> cases(n);
  for (auto& [point, strain, turn] : cases) {
    point.dilation = uniform(-0.4, 0.3);
    point.energy = uniform(0, 5e9);
    point.pressure = uniform(-1e9, 3e10);
    point.viscosity = uniform(0, 1e9);
    point.plastic_strain = uniform(0, 2);

    point.temperature = uniform(293, 800);
    point.damage = uniform(0, 1.2);
    for (T* c :
         {&point.deviator.xx, &point.deviator.yy, &point.deviator.xy, &point.deviator.yz, &point.deviator.zx})
      *c = uniform(-2e8, 2e8);
    point.deviator.zz = -point.deviator.xx - point.deviator.yy;
    for (T* c :
         {&strain.xx, &strain.yy, &strain.zz, &strain.xy, &strain.yz, &strain.zx, &turn.x, &turn.y, &turn.z})
      *c = uniform(-0.02, 0.02);
  }
  return cases;
}

// |a - b| relative to the largest of all: pressures and stresses can pass through zero.
template <class T, class F>
double difference(const std::vector<Result<T>>& a, const std::vector<Result<T>>& b, F&& of) {
  double largest = 0, apart = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::abs(double(of(b[i]))));
    apart = std::max(apart, std::abs(double(of(a[i])) - double(of(b[i]))));
  }
  return apart / largest;
}

template <class T>
void compare(const char* precision, int n) {
  const auto material = al2024().as<T>();
  const auto cases = random_cases<T>(n);
  std::vector<Result<T>> here(n), there(n);
  for (int i = 0; i < n; ++i) here[i] = updated(material, cases[i]);
  Case<T>* given;
  Result<T>* out;
  require(cudaMalloc(&given, n * sizeof(Case<T>)));
  require(cudaMalloc(&out, n * sizeof(Result<T>)));
  require(cudaMemcpy(given, cases.data(), n * sizeof(Case<T>), cudaMemcpyHostToDevice));
  cudaEvent_t begin, end;
  require(cudaEventCreate(&begin));
  require(cudaEventCreate(&end));
  float ms = 0;
  for (int pass = 0; pass < 2; ++pass) {  // the first one loads the code
    require(cudaEventRecord(begin));
    update_all<<<(n + 127) / 128, 128>>>(material, given, out, n);
    require(cudaEventRecord(end));
    require(cudaEventSynchronize(end));
    require(cudaEventElapsedTime(&ms, begin, end));
  }
  require(cudaMemcpy(there.data(), out, n * sizeof(Result<T>), cudaMemcpyDeviceToHost));
  require(cudaFree(given));
  require(cudaFree(out));
  int plastic = 0;
  for (int i = 0; i < n; ++i) plastic += here[i].point.plastic_strain > cases[i].point.plastic_strain;
  const auto show = [&](const char* name, auto&& of) {
    std::printf("\"%s\": %.3g, ", name, difference<T>(there, here, of));
  };
  std::printf("\"%s\": {", precision);
  show("log", [](const auto& r) { return r.log; });
  show("exp", [](const auto& r) { return r.exp; });
  show("pow", [](const auto& r) { return r.pow; });
  show("pressure", [](const auto& r) { return r.point.pressure; });
  show("energy", [](const auto& r) { return r.point.energy; });
  show("deviator", [](const auto& r) { return r.point.deviator.xy; });
  show("plastic_strain", [](const auto& r) { return r.point.plastic_strain; });
  show("temperature", [](const auto& r) { return r.point.temperature; });
  show("damage", [](const auto& r) { return r.point.damage; });
  show("c2", [](const auto& r) { return r.c2; });
  std::printf("\"plastic_points\": %d, \"points\": %d, \"points_per_second\": %.3g}", plastic, n,
              n / (1e-3 * ms));
}

}  // namespace

int main() {
  std::printf("{");
  compare<double>("double", 1 << 20);
  std::printf(", ");
  compare<float>("single", 1 << 20);
  std::printf("}\n");
}
