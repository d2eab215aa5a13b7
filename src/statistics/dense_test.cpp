#include "statistics/dense.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sandlot::statistics {
namespace {

Dense matrix(std::size_t columns, std::vector<double> data) {
  Dense out(data.size() / columns, columns);
  out.data = std::move(data);
  return out;
}

TEST(Dense, SolvesByHand) {
  // x = (1, -2, 3) of a matrix whose factors are L = [1; 2 1; -1 3 1] and D = (2, 5, 1/2).
  const Factors factors(matrix(3, {2, 4, -2, 4, 13, 11, -2, 11, 47.5}));
  const std::vector<double> x = factors.solve({2 - 8 - 6, 4 - 26 + 33, -2 - 22 + 142.5});
  EXPECT_NEAR(x[0], 1, 1e-12);
  EXPECT_NEAR(x[1], -2, 1e-12);
  EXPECT_NEAR(x[2], 3, 1e-12);
}

TEST(Dense, ASemidefiniteMatrixLeavesOutTheDirectionWithoutInformation) {
  const Factors factors(matrix(2, {4, 2, 2, 1}));
  const std::vector<double> x = factors.solve({8, 4});
  EXPECT_EQ(x[1], 0);
  EXPECT_EQ(x[0], 2);
  EXPECT_EQ(factors.least_pivot(), 0);
  // D of [4 2; 2 2] is (4, 1).
  EXPECT_EQ(Factors(matrix(2, {4, 2, 2, 2})).least_pivot(), 0.5);
}

TEST(Dense, InverseAndEigenPairsOfRandomMatrices) {
  Stream random(7, entity_key("dense"), Purpose::controller, 0);
  for (const std::size_t n : {1u, 2u, 5u, 12u}) {
    Dense B(n, n), A(n, n);
    for (double& b : B.data) b = random.normal();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        for (std::size_t k = 0; k < n; ++k) A(i, j) += B(i, k) * B(j, k);
        A(i, j) += i == j ? 1 : 0;
      }
    const Dense inverse = Factors(A).inverse();
    const EigenPairs eigen = eigen_pairs(A);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        double product = 0, turned = 0, across = 0;
        for (std::size_t k = 0; k < n; ++k) {
          product += A(i, k) * inverse(k, j);
          turned += A(i, k) * eigen.vectors(k, j);
          across += eigen.vectors(k, i) * eigen.vectors(k, j);
        }
        // Elements are some 100 at most, the smallest eigenvalue is 1 or more: rounding stays below 1e-11.
        EXPECT_NEAR(product, i == j ? 1 : 0, 1e-11);
        EXPECT_NEAR(turned, eigen.values[j] * eigen.vectors(i, j), 1e-11);
        EXPECT_NEAR(across, i == j ? 1 : 0, 1e-12);
      }
    for (std::size_t j = 1; j < n; ++j) EXPECT_LE(eigen.values[j - 1], eigen.values[j]);
  }
}

}  // namespace
}  // namespace sandlot::statistics
