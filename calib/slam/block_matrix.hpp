// A sparse symmetric matrix made of small dense blocks, one block row per vertex, and its factorisation.
#pragma once

#include <Eigen/SparseCholesky>
#include <complex>
#include <optional>
#include <utility>
#include <vector>

namespace odomcalib::calib::slam {

/// Two blocks that share an off-diagonal block.
using BlockLink = std::pair<std::size_t, std::size_t>;

/// Order of elimination with little fill-in: approximate minimum degree on blocks, which are an order of
/// magnitude fewer than entries.
/// @return for each block its place in the order
std::vector<std::size_t> elimination_places(std::size_t blocks, const std::vector<BlockLink>& links);

/// Symmetric (or Hermitian) matrix of blocks of at most 3 x 3. Only the upper triangle is stored, by columns
/// in the order of elimination, so that it is factorised as it lies.
template <typename Scalar>
class BlockMatrix {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using Block = Eigen::Matrix<Scalar, 3, 3>;

  /// Where an off-diagonal block is; found once per edge, used in every iteration.
  struct Slot {
    std::size_t column = 0;   ///< block whose column holds it
    Eigen::Index offset = 0;  ///< rows above it in that column
    bool flipped = false;     ///< stored transposed: the row was eliminated after the column
  };

  /// @param sizes rows of each block, up to 3; 0 leaves a block out
  /// @param places of the blocks in the order of elimination
  BlockMatrix(std::vector<Eigen::Index> sizes, const std::vector<BlockLink>& links,
              const std::vector<std::size_t>& places);

  [[nodiscard]] Slot slot(std::size_t row, std::size_t column) const;
  /// First row of a block, in right-hand sides and solutions too.
  [[nodiscard]] Eigen::Index row(std::size_t block) const { return columns_[block].row; }
  [[nodiscard]] Eigen::Index size(std::size_t block) const { return sizes_[block]; }
  [[nodiscard]] Eigen::Index rows() const { return matrix_.rows(); }

  void set_zero() { matrix_.coeffs().setZero(); }
  /// Blocks are cut to the sizes of their row and column.
  void add_diagonal(std::size_t block, const Block& values);
  void add(const Slot& slot, std::size_t row, std::size_t column, const Block& values);

  [[nodiscard]] Eigen::VectorXd diagonal() const;
  /// Factorises the matrix plus `damping` on its diagonal.
  /// @return a row about which the others leave nothing to know, if there is one: the matrix is singular
  std::optional<Eigen::Index> factorize(const Eigen::VectorXd& damping);
  [[nodiscard]] Vector solve(const Vector& right_side) const { return solver_.solve(right_side); }

 private:
  struct Column {
    Eigen::Index row = 0;                                     // first row and first scalar column
    Eigen::Index height = 0;                                  // rows above the diagonal block
    std::vector<std::pair<std::size_t, Eigen::Index>> above;  // block above, its offset; by place
  };
  void lay_out_columns(const std::vector<BlockLink>& links, const std::vector<std::size_t>& places);
  void fill_pattern(const std::vector<std::size_t>& order);
  Scalar* numbers(const Column& column, Eigen::Index k) {
    return matrix_.valuePtr() + matrix_.outerIndexPtr()[column.row + k];
  }

  std::vector<Eigen::Index> sizes_;
  std::vector<std::size_t> places_;
  std::vector<Column> columns_;  // per block
  Eigen::SparseMatrix<Scalar> matrix_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<Scalar>, Eigen::Upper, Eigen::NaturalOrdering<int>> solver_;
  bool analysed_ = false;
};

extern template class BlockMatrix<double>;
extern template class BlockMatrix<std::complex<double>>;

}  // namespace odomcalib::calib::slam
