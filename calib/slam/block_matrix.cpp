#include "calib/slam/block_matrix.hpp"

#include <Eigen/OrderingMethods>
#include <algorithm>

namespace odomcalib::calib::slam {
namespace {

/// A pivot this small beside its diagonal entry is rounding: 1e-16 times the operations behind it.
constexpr double kSmallestPivot = 1e-13;

std::vector<std::size_t> order_of(const std::vector<std::size_t>& places) {
  std::vector<std::size_t> order(places.size());
  for (std::size_t block = 0; block < places.size(); ++block) order[places[block]] = block;
  return order;
}

}  // namespace

std::vector<std::size_t> elimination_places(std::size_t blocks, const std::vector<BlockLink>& links) {
  using Triplet = Eigen::Triplet<double, int>;
  std::vector<Triplet> entries;
  entries.reserve(2 * links.size() + blocks);
  for (const auto& [a, b] : links) {
    entries.emplace_back(static_cast<int>(a), static_cast<int>(b), 1.0);
    entries.emplace_back(static_cast<int>(b), static_cast<int>(a), 1.0);
  }
  for (int i = 0; i < static_cast<int>(blocks); ++i) entries.emplace_back(i, i, 1.0);
  Eigen::SparseMatrix<double> pattern(static_cast<Eigen::Index>(blocks), static_cast<Eigen::Index>(blocks));
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern, order);
  std::vector<std::size_t> places(blocks);
  for (std::size_t place = 0; place < blocks; ++place)
    places[static_cast<std::size_t>(order.indices()[static_cast<Eigen::Index>(place)])] = place;
  return places;
}

template <typename Scalar>
BlockMatrix<Scalar>::BlockMatrix(std::vector<Eigen::Index> sizes, const std::vector<BlockLink>& links,
                                 const std::vector<std::size_t>& places)
    : sizes_(std::move(sizes)), places_(places), columns_(sizes_.size()) {
  lay_out_columns(links, places);
  fill_pattern(order_of(places));
}

template <typename Scalar>
void BlockMatrix<Scalar>::lay_out_columns(const std::vector<BlockLink>& links,
                                          const std::vector<std::size_t>& places) {
  for (auto [a, b] : links) {
    if (sizes_[a] == 0 || sizes_[b] == 0) continue;
    if (places[a] > places[b]) std::swap(a, b);
    columns_[b].above.emplace_back(a, 0);
  }
  for (Column& column : columns_) {
    auto& above = column.above;
    std::sort(above.begin(), above.end(),
              [&places](const auto& a, const auto& b) { return places[a.first] < places[b.first]; });
    above.erase(std::unique(above.begin(), above.end()), above.end());
    for (auto& [block, offset] : above) {
      offset = column.height;
      column.height += sizes_[block];
    }
  }
}

template <typename Scalar>
void BlockMatrix<Scalar>::fill_pattern(const std::vector<std::size_t>& order) {
  Eigen::Index rows = 0;
  Eigen::Index entries = 0;
  for (const std::size_t block : order) {
    columns_[block].row = rows;
    rows += sizes_[block];
    entries += sizes_[block] * columns_[block].height + sizes_[block] * (sizes_[block] + 1) / 2;
  }
  matrix_.resize(rows, rows);
  matrix_.resizeNonZeros(entries);
  int* outer = matrix_.outerIndexPtr();
  int* inner = matrix_.innerIndexPtr();
  *outer = 0;
  for (const std::size_t block : order) {
    for (Eigen::Index k = 0; k < sizes_[block]; ++k) {
      const int* const begin = inner;
      for (const auto& [above, offset] : columns_[block].above)
        for (Eigen::Index i = 0; i < sizes_[above]; ++i) *inner++ = static_cast<int>(columns_[above].row + i);
      for (Eigen::Index i = 0; i <= k; ++i) *inner++ = static_cast<int>(columns_[block].row + i);
      outer[1] = *outer + static_cast<int>(inner - begin);
      ++outer;
    }
  }
  set_zero();
}

template <typename Scalar>
typename BlockMatrix<Scalar>::Slot BlockMatrix<Scalar>::slot(std::size_t row, std::size_t column) const {
  Slot slot{column, 0, false};
  if (sizes_[row] == 0 || sizes_[column] == 0) return slot;
  if (places_[row] > places_[column]) {
    slot = {row, 0, true};
    std::swap(row, column);
  }
  const auto& above = columns_[column].above;
  const auto found =
      std::lower_bound(above.begin(), above.end(), places_[row],
                       [this](const auto& entry, std::size_t place) { return places_[entry.first] < place; });
  slot.offset = found->second;
  return slot;
}

template <typename Scalar>
void BlockMatrix<Scalar>::add_diagonal(std::size_t block, const Block& values) {
  const Column& column = columns_[block];
  for (Eigen::Index k = 0; k < sizes_[block]; ++k) {
    Scalar* const number = numbers(column, k) + column.height;
    for (Eigen::Index i = 0; i <= k; ++i) number[i] += values(i, k);
  }
}

template <typename Scalar>
void BlockMatrix<Scalar>::add(const Slot& slot, std::size_t row, std::size_t column, const Block& values) {
  const Column& stored = columns_[slot.column];
  const Block block = slot.flipped ? Block(values.adjoint()) : values;
  if (slot.flipped) std::swap(row, column);
  for (Eigen::Index k = 0; k < sizes_[column]; ++k) {
    Scalar* const number = numbers(stored, k) + slot.offset;
    for (Eigen::Index i = 0; i < sizes_[row]; ++i) number[i] += block(i, k);
  }
}

template <typename Scalar>
Eigen::VectorXd BlockMatrix<Scalar>::diagonal() const {
  Eigen::VectorXd diagonal(rows());
  // The diagonal entry ends its column.
  for (Eigen::Index k = 0; k < rows(); ++k)
    diagonal[k] = std::real(matrix_.valuePtr()[matrix_.outerIndexPtr()[k + 1] - 1]);
  return diagonal;
}

template <typename Scalar>
std::optional<Eigen::Index> BlockMatrix<Scalar>::factorize(const Eigen::VectorXd& damping) {
  if (!analysed_) solver_.analyzePattern(matrix_);
  analysed_ = true;
  const Eigen::VectorXd plain = diagonal();
  for (Eigen::Index k = 0; k < rows(); ++k)
    matrix_.valuePtr()[matrix_.outerIndexPtr()[k + 1] - 1] += damping[k];
  solver_.factorize(matrix_);
  const Eigen::VectorXd pivots = solver_.vectorD().real();
  for (Eigen::Index k = 0; k < rows(); ++k) {
    matrix_.valuePtr()[matrix_.outerIndexPtr()[k + 1] - 1] = plain[k];
    // Written so that a pivot that is no number counts as too small.
    if (!(pivots[k] > kSmallestPivot * (plain[k] + damping[k]))) return k;
  }
  return std::nullopt;
}

template class BlockMatrix<double>;
template class BlockMatrix<std::complex<double>>;

}  // namespace odomcalib::calib::slam
