// g2o and TORO text, line by line. Lines are collected first: edges may come before their vertices.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <unordered_map>

#include "proto/file_bytes.hpp"
#include "proto/recording/pose_graph.hpp"

namespace odomcalib {
namespace {

/// Rounding in text may push a singular matrix slightly below zero; relative to its unit diagonal.
constexpr double kPositiveTolerance = 1e-6;

enum class LineKind { vertex_pose, vertex_point, edge_pose, edge_pose_old, edge_point, fix };

struct Tag {
  LineKind kind;
  std::size_t ids;
  std::size_t numbers;
};

std::optional<Tag> known_tag(std::string_view name) {
  if (name == "VERTEX_SE2" || name == "VERTEX2" || name == "VERTEX") return Tag{LineKind::vertex_pose, 1, 3};
  if (name == "VERTEX_XY") return Tag{LineKind::vertex_point, 1, 2};
  if (name == "EDGE_SE2") return Tag{LineKind::edge_pose, 2, 9};
  if (name == "EDGE2" || name == "EDGE") return Tag{LineKind::edge_pose_old, 2, 9};
  if (name == "EDGE_SE2_XY") return Tag{LineKind::edge_point, 2, 5};
  if (name == "FIX") return Tag{LineKind::fix, 1, 0};
  return std::nullopt;
}

std::string_view next_word(std::string_view& line) {
  constexpr std::string_view kBlank = " \t\r\v\f";
  line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
  const auto word = line.substr(0, line.find_first_of(kBlank));
  line.remove_prefix(word.size());
  return word;
}

template <typename Number>
bool parse_number(std::string_view word, Number& number) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), number);
  return code == std::errc() && end == word.data() + word.size();
}

bool is_positive_semidefinite(const std::array<double, 6>& information) {
  const auto& [xx, xy, xt, yy, yt, tt] = information;
  if (xx < 0.0 || yy < 0.0 || tt < 0.0) return false;
  // Correlations; a zero on the diagonal allows no other entry in its row.
  const auto correlation = [](double entry, double a, double b) {
    return entry == 0.0 ? 0.0 : entry / (std::sqrt(a) * std::sqrt(b));
  };
  const double a = correlation(xy, xx, yy);
  const double b = correlation(xt, xx, tt);
  const double c = correlation(yt, yy, tt);
  const double largest = std::max({std::abs(a), std::abs(b), std::abs(c)});
  return largest <= 1.0 + kPositiveTolerance &&
         1.0 + 2.0 * a * b * c - a * a - b * b - c * c >= -kPositiveTolerance;
}

/// An edge or FIX line, kept until all vertices are known.
struct Reference {
  std::array<std::int64_t, 2> ids{};
  bool to_point = false;
  GraphEdge edge;
  std::string where;
};

class Reader {
 public:
  Result<void> read(std::string_view text, const std::string& name);
  Result<PoseGraph> finish();

 private:
  Error error(const std::string& what, const std::string& remedy) const {
    return {ErrorCode::format, what, where(), remedy};
  }
  [[nodiscard]] std::string where() const { return name_ + ":" + std::to_string(line_); }

  Result<void> read_line(std::string_view line);
  Result<void> skip(std::string_view tag);
  Result<void> read_known(const Tag& tag, std::string_view name, std::string_view rest);
  Result<void> add_vertex(const Tag& tag, std::int64_t id, const std::array<double, 9>& numbers);
  Result<void> add_edge(const Tag& tag, const std::array<std::int64_t, 2>& ids,
                        const std::array<double, 9>& numbers);
  Result<void> add_fixes(std::string_view rest);
  void place_vertices_of_edges();
  Result<std::size_t> find(std::int64_t id, const std::string& where) const;
  Result<void> link(Reference& reference);

  std::string name_;
  std::size_t line_ = 0;
  PoseGraph graph_;
  std::unordered_map<std::int64_t, std::size_t> positions_;  // id -> place in graph_.vertices
  std::vector<std::string> declared_;                        // where each vertex stands, for duplicates
  std::vector<Reference> edges_;
  std::vector<Reference> fixes_;
  std::map<std::string, std::size_t, std::less<>> skipped_;  // tag -> lines
};

Result<void> Reader::read(std::string_view text, const std::string& name) {
  name_ = name;
  line_ = 0;
  while (!text.empty()) {
    ++line_;
    const auto line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (auto read = read_line(line); !read) return read;
  }
  return {};
}

Result<void> Reader::read_line(std::string_view line) {
  const auto name = next_word(line);
  if (name.empty() || name.starts_with('#')) return {};
  const auto tag = known_tag(name);
  if (!tag) return skip(name);
  return tag->kind == LineKind::fix ? add_fixes(line) : read_known(*tag, name, line);
}

/// Another vertex or edge would change the answer; other lines (parameters, laser scans) would not.
Result<void> Reader::skip(std::string_view tag) {
  const std::string shown(tag.substr(0, 40));
  if (tag.starts_with("VERTEX") || tag.starts_with("EDGE"))
    return error("\"" + shown + "\" is no planar vertex or edge that can be used",
                 "planar graphs hold VERTEX_SE2, VERTEX_XY, EDGE_SE2, EDGE_SE2_XY");
  constexpr std::size_t kNamedTags = 20;
  const bool named = skipped_.contains(shown) || skipped_.size() < kNamedTags;
  ++skipped_[named ? shown : "other"];
  return {};
}

Result<void> Reader::read_known(const Tag& tag, std::string_view name, std::string_view rest) {
  std::array<std::int64_t, 2> ids{};
  std::array<double, 9> numbers{};
  const std::string expected =
      std::string(name) + " takes " + std::to_string(tag.ids + tag.numbers) + " numbers";
  for (std::size_t i = 0; i < tag.ids + tag.numbers; ++i) {
    const auto word = next_word(rest);
    if (word.empty())
      return error(expected + ", this line ends after " + std::to_string(i), "is the file cut off?");
    const std::size_t k = i - std::min(i, tag.ids);
    const bool good = i < tag.ids ? parse_number(word, ids.at(i))
                                  : parse_number(word, numbers.at(k)) && std::isfinite(numbers.at(k));
    if (!good)
      return error("\"" + std::string(word.substr(0, 40)) + "\" is no " +
                       (i < tag.ids ? "vertex number" : "finite number"),
                   "correct or remove the line");
  }
  if (!next_word(rest).empty()) return error(expected + ", this line has more", "is the tag right?");
  return tag.ids == 1 ? add_vertex(tag, ids[0], numbers) : add_edge(tag, ids, numbers);
}

Result<void> Reader::add_vertex(const Tag& tag, std::int64_t id, const std::array<double, 9>& numbers) {
  const auto [known, is_new] = positions_.try_emplace(id, graph_.vertices.size());
  if (!is_new)
    return error("vertex " + std::to_string(id) + " was already at " + declared_[known->second],
                 "keep one of the two lines");
  const bool pose = tag.kind == LineKind::vertex_pose;
  graph_.vertices.push_back(
      {id, pose ? VertexKind::pose : VertexKind::point, numbers[0], numbers[1], numbers[2], false});
  declared_.push_back(where());
  return {};
}

Result<void> Reader::add_edge(const Tag& tag, const std::array<std::int64_t, 2>& ids,
                              const std::array<double, 9>& numbers) {
  const std::string edge = "edge " + std::to_string(ids[0]) + " -> " + std::to_string(ids[1]);
  if (ids[0] == ids[1]) return error(edge + " joins a vertex to itself", "remove the line");
  Reference reference{ids, tag.kind == LineKind::edge_point, {}, where()};
  const auto& n = numbers;
  if (reference.to_point) {
    reference.edge.motion = {n[0], n[1], 0.0};
    reference.edge.information = {n[2], n[3], 0.0, n[4], 0.0, 0.0};
  } else {
    reference.edge.motion = {n[0], n[1], n[2]};
    // The older tags end with the rotation's own entry before its cross terms: xx xy yy tt xt yt.
    if (tag.kind == LineKind::edge_pose_old)
      reference.edge.information = {n[3], n[4], n[7], n[5], n[8], n[6]};
    else
      reference.edge.information = {n[3], n[4], n[5], n[6], n[7], n[8]};
  }
  if (!is_positive_semidefinite(reference.edge.information))
    return error(
        "the information matrix of " + edge + " is not positive semidefinite",
        "EDGE_SE2 is ordered xx xy xt yy yt tt, EDGE2 and EDGE xx xy yy tt xt yt: is the tag right?");
  edges_.push_back(std::move(reference));
  return {};
}

Result<void> Reader::add_fixes(std::string_view rest) {
  std::size_t count = 0;
  for (auto word = next_word(rest); !word.empty(); word = next_word(rest), ++count) {
    Reference fix;
    if (!parse_number(word, fix.ids[0]))
      return error("\"" + std::string(word.substr(0, 40)) + "\" is no vertex number",
                   "correct or remove the line");
    fix.where = where();
    fixes_.push_back(std::move(fix));
  }
  return count > 0 ? Result<void>{} : error("FIX without a vertex number", "correct or remove the line");
}

/// A file without any vertex line means: the vertices are those that the edges name, in the order of ids.
void Reader::place_vertices_of_edges() {
  std::map<std::int64_t, VertexKind> kinds;
  for (const Reference& reference : edges_) {
    kinds.try_emplace(reference.ids[0], VertexKind::pose);
    kinds.try_emplace(reference.ids[1], reference.to_point ? VertexKind::point : VertexKind::pose);
  }
  for (const auto& [id, kind] : kinds) {
    positions_[id] = graph_.vertices.size();
    graph_.vertices.push_back({id, kind, 0.0, 0.0, 0.0, false});
  }
  graph_.has_positions = false;
}

Result<std::size_t> Reader::find(std::int64_t id, const std::string& where) const {
  const auto found = positions_.find(id);
  if (found != positions_.end()) return found->second;
  return Error{ErrorCode::format, "names vertex " + std::to_string(id) + ", which no VERTEX line declares",
               where, "add the vertex, or remove all VERTEX lines to start from the edges alone"};
}

Result<void> Reader::link(Reference& reference) {
  const auto from = find(reference.ids[0], reference.where);
  if (!from) return from.error();
  const auto to = find(reference.ids[1], reference.where);
  if (!to) return to.error();
  const auto wanted = reference.to_point ? VertexKind::point : VertexKind::pose;
  if (graph_.vertices[from.value()].kind != VertexKind::pose || graph_.vertices[to.value()].kind != wanted)
    return Error{ErrorCode::format, "the edge does not fit the kind of its vertices", reference.where,
                 "EDGE_SE2 joins two VERTEX_SE2, EDGE_SE2_XY a VERTEX_SE2 and a VERTEX_XY"};
  reference.edge.from = from.value();
  reference.edge.to = to.value();
  graph_.edges.push_back(reference.edge);
  return {};
}

Result<PoseGraph> Reader::finish() {
  if (graph_.vertices.empty()) place_vertices_of_edges();
  if (graph_.vertices.empty())
    return Error{ErrorCode::format, "no vertex and no edge", name_, "give a pose graph in g2o or TORO text"};
  graph_.edges.reserve(edges_.size());
  for (Reference& reference : edges_)
    if (auto linked = link(reference); !linked) return linked.error();
  for (const Reference& fix : fixes_) {
    const auto vertex = find(fix.ids[0], fix.where);
    if (!vertex) return vertex.error();
    graph_.vertices[vertex.value()].fixed = true;
  }
  for (const auto& [tag, lines] : skipped_)
    graph_.notes.push_back("skipped " + std::to_string(lines) + " lines \"" + tag + "\"");
  return std::move(graph_);
}

Result<std::string> unpacked(const std::filesystem::path& path, const UnpackLimit& limit) {
  auto bytes = read_file_bytes(path);
  if (!bytes || !is_gzip(bytes.value())) return bytes;
  auto text = gunzip(bytes.value(), limit);
  if (text.over_limit) return limit.refusal(bytes.value().size(), path.string());
  // A graph that lacks its end is another graph.
  if (!text.whole) return Error{ErrorCode::format, text.problem, path.string(), "get the whole file"};
  return std::move(text.bytes);
}

}  // namespace

Result<PoseGraph> read_pose_graph(std::span<const std::filesystem::path> files, const UnpackLimit& limit) {
  Reader reader;
  for (const auto& path : files) {
    const auto text = unpacked(path, limit);
    if (!text) return text.error();
    if (auto read = reader.read(text.value(), path.string()); !read) return read.error();
  }
  return reader.finish();
}

Result<PoseGraph> read_pose_graph_text(std::string_view text, const std::string& where) {
  Reader reader;
  if (auto read = reader.read(text, where); !read) return read.error();
  return reader.finish();
}

}  // namespace odomcalib
