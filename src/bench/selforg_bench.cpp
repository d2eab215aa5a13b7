/// Self-organisation: a learning step of a Sox of 18 sensors and 18 motors, the size of a hexapod.
///
/// The reference is the same rule in bare Eigen: dynamic matrices that are kept, noalias products, two inverses by partial
/// pivoting (A and L), tanh element by element.
#include <Eigen/Dense>
#include <memory>

#include "base/math.h"
#include "base/random.h"
#include "bench/bench.h"
#include "selforg/sox/sox.h"

namespace sandlot::bench {
namespace {

constexpr int size = 18, steps = 2000;

struct Bare {
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(size, size), C = A, S = 0.05 * A, native_A = A,
                  native_C = 1.2 * A;
  Eigen::VectorXd h = Eigen::VectorXd::Zero(size), b = h, x_then = h, y_then = h;
  Eigen::MatrixXd L, L_inverse, A_inverse;
  Eigen::VectorXd xi, z, y, g, eta, y_hat, v, chi, mu, Cv, epsrel, v_avg = h;

  void step(const Eigen::VectorXd& x, Eigen::VectorXd& out) {
    xi = x - b;
    xi.noalias() -= A * y_then;
    xi.noalias() -= S * x_then;
    z = h;
    z.noalias() += C * x_then;
    y = z.unaryExpr([](double each) { return math::tanh(each); });
    g = 1 - y.array().square();
    L = S;
    L.noalias() += A * (g.asDiagonal() * C);
    L_inverse = L.inverse();
    A_inverse = A.inverse();
    eta.noalias() = A_inverse * xi;
    y_hat = y + 0.01 * eta;
    v.noalias() = L_inverse * xi;
    chi.noalias() = L_inverse.transpose() * v;
    mu.noalias() = A.transpose() * chi;
    mu.array() *= g.array();
    Cv.noalias() = C * v;
    epsrel = (2 * mu.array() * Cv.array() * y.array()).matrix();
    v_avg += 0.1 * (v - v_avg);
    A.array() += (0.1 * xi * y_hat.transpose()).array().max(-0.1).min(0.1) +
                 ((native_A - A).array().cube() * 1e-5).max(-0.1).min(0.1);
    S.array() += ((0.1 * xi * x_then.transpose()) - 1e-4 * S).array().max(-0.1).min(0.1);
    b.array() += (0.1 * xi - 1e-5 * b).array().max(-0.1).min(0.1);
    C.array() += (0.1 * (mu * v.transpose() - epsrel * x_then.transpose())).array().max(-0.05).min(0.05) +
                 ((native_C - C).array().cube() * 1e-5).max(-0.05).min(0.05);
    h.array() += (-0.1 * epsrel).array().max(-0.05).min(0.05);
    z = h;
    z.noalias() += C * x;
    out = z.unaryExpr([](double each) { return math::tanh(each); });
    x_then = x;
    y_then = out;
  }
};

}  // namespace

std::vector<Row> sox() {
  auto ours = selforg::make_controller("sox", {size, size});
  Bare bare;
  std::vector<double> x(size), y(size);
  Eigen::VectorXd bare_x = Eigen::VectorXd::Zero(size), bare_y = bare_x;
  std::uint64_t k = 0, bare_k = 0;
  const auto world = [](auto& to, const auto& from, std::uint64_t at) {
    for (int i = 0; i < size; ++i)
      to[static_cast<std::size_t>(i)] =
          0.8 * from[static_cast<std::size_t>(i)] +
          0.1 * std::abs(static_cast<double>((at + 7 * static_cast<std::uint64_t>(i)) % 40) - 20) / 20;
  };
  const Timing time = compare(
      15,
      [&] {
        for (int n = 0; n < steps; ++n) {
          (*ours)->step(x, y);
          world(x, y, k++);
        }
      },
      [&] {
        for (int n = 0; n < steps; ++n) {
          bare.step(bare_x, bare_y);
          for (int i = 0; i < size; ++i)
            bare_x[i] = 0.8 * bare_y[i] +
                        0.1 *
                            std::abs(static_cast<double>((bare_k + 7 * static_cast<std::uint64_t>(i)) % 40) -
                                     20) /
                            20;
          ++bare_k;
        }
      });
  return {row("selforg: Sox step, 18 x 18, against bare Eigen", "us", time.ours_s / steps * 1e6,
              time.reference_s / steps * 1e6, 1.2)};
}

}  // namespace sandlot::bench
