#include "selforg/matrix.h"

#include "selforg/test_reference.h"

namespace sandlot::selforg::test {
namespace {

Stream stream(std::uint64_t sample) { return {7, entity_key("matrix"), Purpose::experiment, sample}; }

TEST(Matrix, ProductsOfRandomSizesMatchTheLiteralOnes) {
  for (std::uint64_t k = 0; k < 40; ++k) {
    Stream random = stream(k);
    const std::size_t n = 1 + random.below(20), m = 1 + random.below(20), p = 1 + random.below(20);
    const Matrix A = random_matrix(random, n, m), B = random_matrix(random, m, p),
                 x = random_matrix(random, m, 1);
    const Matrix y = random_matrix(random, n, 1), g = random_matrix(random, m, 1),
                 D = random_matrix(random, p, m);
    Matrix AB(n, p), Ax(n, 1), Aty(m, 1), ADt(n, p), AtA(m, m);
    multiply_matrices(A, B, AB);
    expect_near(AB, Ref(A) * Ref(B), 1e-14, "A B");
    multiply(A, x, Ax);
    expect_near(Ax, Ref(A) * Ref(x), 1e-14, "A x");
    multiply_transposed(A, y, Aty);
    expect_near(Aty, Ref(A).T() * Ref(y), 1e-14, "A^T y");
    multiply_by_transposed(A, D, ADt);
    expect_near(ADt, Ref(A) * Ref(D).T(), 1e-14, "A D^T");
    multiply_transposed_matrices(A, A, AtA);
    expect_near(AtA, Ref(A).T() * Ref(A), 1e-14, "A^T A");
    multiply_scaled_rows(A, B, g, AB);
    expect_near(AB, Ref(A) * (Ref(B) & Ref(g)), 1e-14, "A (B & g)");
    EXPECT_NEAR(squared_norm(A), static_cast<double>(norm2(A)), 1e-12);
  }
}

TEST(Matrix, PseudoInversesOfEveryShapeMatchTheLiteralOnes) {
  for (std::uint64_t k = 0; k < 60; ++k) {
    Stream random = stream(100 + k);
    const std::size_t n = 1 + random.below(18), m = k % 3 == 0 ? n : 1 + random.below(18);
    Matrix A = random_matrix(random, n, m, 0.3);
    for (std::size_t i = 0; i < std::min(n, m); ++i) A(i, i) += 2;  // far from singular
    const Matrix x = random_matrix(random, n, 1), y = random_matrix(random, m, 1);
    Matrix out(m, 1), back(n, 1);
    PseudoInverse inverse_of(n, m);
    inverse_of.factor(A);
    EXPECT_FALSE(inverse_of.singular());
    inverse_of.apply(x, out);
    expect_near(out, pinv(A) * Ref(x), 1e-12, "A^+ x");
    inverse_of.apply_transposed(y, back);
    expect_near(back, pinv(A).T() * Ref(y), 1e-12, "(A^+)^T y");
  }
}

TEST(Matrix, PermutationsAreInvertedExactly) {
  // Zeros on the diagonal: wrong without pivoting.
  Matrix P(4, 4);
  const std::size_t to[] = {2, 0, 3, 1};
  for (std::size_t i = 0; i < 4; ++i) P(to[i], i) = 1;
  PseudoInverse inverse_of(4, 4);
  inverse_of.factor(P);
  Matrix x(4, 1), out(4, 1), back(4, 1);
  for (std::size_t i = 0; i < 4; ++i) x[i] = static_cast<double>(i + 1);
  inverse_of.apply(x, out);
  inverse_of.apply_transposed(x, back);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(out[i], x[to[i]]);
    EXPECT_EQ(back[to[i]], x[i]);
  }
}

TEST(Matrix, ASingularMatrixGivesTheSmallestSolution) {
  // diag(2, 0): its pseudo-inverse is diag(1/2, 0). The regularisation 1e-8 * 2 is relative to 4.
  Matrix D(2, 2);
  D(0, 0) = 2;
  PseudoInverse inverse_of(2, 2);
  inverse_of.factor(D);
  EXPECT_TRUE(inverse_of.singular());
  Matrix x(2, 1, 1), out(2, 1);
  inverse_of.apply(x, out);
  EXPECT_NEAR(out[0], 0.5, 1e-8);
  EXPECT_EQ(out[1], 0);
  // Rank 1 of 3 x 2: [1 1; 1 1; 1 1]^+ = 1/6 everywhere.
  const Matrix ones(3, 2, 1), u(3, 1, 1);
  PseudoInverse thin(3, 2);
  thin.factor(ones);
  EXPECT_TRUE(thin.singular());
  thin.apply(u, out);
  EXPECT_NEAR(out[0], 0.5, 1e-6);
  EXPECT_NEAR(out[1], 0.5, 1e-6);
  // Nothing at all, and no dimensions.
  thin.factor(Matrix(3, 2));
  thin.apply(u, out);
  EXPECT_EQ(out[0], 0);
  PseudoInverse none(3, 0);
  none.factor(Matrix(3, 0));
  Matrix empty(0, 1);
  none.apply(u, empty);
}

TEST(Matrix, ClippingMakesANumberOfAnything) {
  EXPECT_EQ(clipped(3, 1), 1);
  EXPECT_EQ(clipped(-3, 1), -1);
  EXPECT_EQ(clipped(0.5, 1), 0.5);
  EXPECT_EQ(clipped(std::nan(""), 1), 0);
  EXPECT_EQ(clipped(-std::numeric_limits<double>::infinity(), 1), -1);
}

}  // namespace
}  // namespace sandlot::selforg::test
