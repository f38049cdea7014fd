// g2o and TORO text, line by line. Lines are collected first: edges may come before their vertices.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <unordered_map>

#include "proto/file_bytes.hpp"
#include "proto/recording/pose_graph.hpp"

namespace odomcalib {
namespace {

/// Rounding in text may push a singular matrix slightly below zero; relative to its unit diagonal.
constexpr double kPositiveTolerance = 1e-6;
// Tags that a message names; a file that is no pose graph may have one in every line.
constexpr std::size_t kNamedTags = 20;

enum class LineKind { vertex_pose, vertex_point, edge_pose, edge_pose_old, edge_point, equivalent, fix };

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
  if (name == "EQUIV") return Tag{LineKind::equivalent, 2, 0};
  if (name == "FIX") return Tag{LineKind::fix, 1, 0};
  return std::nullopt;
}

/// Every vertex and edge of g2o and TORO has one of the two words in its tag, as TUTORIAL_VERTEX_SE2 has.
bool names_vertex_or_edge(std::string_view tag) {
  std::string upper(tag);
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return upper.find("VERTEX") != std::string::npos || upper.find("EDGE") != std::string::npos;
}

struct CountedTag {
  std::string tag;
  std::size_t lines = 0;
};

void count(std::vector<CountedTag>& tags, const std::string& tag) {
  const auto known =
      std::find_if(tags.begin(), tags.end(), [&](const CountedTag& one) { return one.tag == tag; });
  if (known != tags.end())
    ++known->lines;
  else if (tags.size() < kNamedTags)
    tags.push_back({tag, 1});
  else
    count(tags, "other");
}

std::string list_of(const std::vector<CountedTag>& tags) {
  std::string list;
  for (const auto& [tag, lines] : tags)
    list += (list.empty() ? "\"" : ", \"") + tag + "\" (" + std::to_string(lines) +
            (lines == 1 ? " line)" : " lines)");
  return list;
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
  void skip(std::string_view tag);
  Result<void> read_known(const Tag& tag, std::string_view name, std::string_view rest);
  Result<void> add_vertex(const Tag& tag, std::int64_t id, const std::array<double, 9>& numbers);
  Result<void> add_edge(const Tag& tag, const std::array<std::int64_t, 2>& ids,
                        const std::array<double, 9>& numbers);
  Result<void> add_equivalence(const std::array<std::int64_t, 2>& ids);
  Result<void> add_fixes(std::string_view rest);
  void place_vertices_of_edges();
  [[nodiscard]] Error no_graph() const;
  Result<std::size_t> find(std::int64_t id, const std::string& where) const;
  Result<void> join_places();
  void keep_places(const std::vector<std::size_t>& place);
  void note_what_was_left_out();
  Result<void> link(Reference& reference);

  std::string name_;
  std::size_t line_ = 0;
  PoseGraph graph_;
  std::unordered_map<std::int64_t, std::size_t> positions_;  // id -> place in graph_.vertices
  std::vector<std::string> declared_;                        // where each vertex stands, for duplicates
  std::vector<Reference> edges_;
  std::vector<Reference> fixes_;
  std::vector<Reference> equivalences_;
  std::size_t within_place_ = 0;  // edges between two numbers of one place
  std::vector<CountedTag> skipped_;
  std::vector<CountedTag> unusable_;  // vertices and edges of other kinds
  std::string first_unusable_;        // where it stands
};

Result<void> Reader::read(std::string_view text, const std::string& name) {
  name_ = name;
  line_ = 0;
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    return Error{ErrorCode::format, "is text in UTF-16", name_, "save it as UTF-8"};
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
  if (!tag) {
    skip(name);
    return {};
  }
  return tag->kind == LineKind::fix ? add_fixes(line) : read_known(*tag, name, line);
}

/// Another vertex or edge would change the answer; other lines (parameters, laser scans) would not.
void Reader::skip(std::string_view tag) {
  const std::string shown(tag.substr(0, 40));
  if (!names_vertex_or_edge(tag)) return count(skipped_, shown);
  if (unusable_.empty()) first_unusable_ = where();
  count(unusable_, shown);
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
  if (tag.kind == LineKind::equivalent) return add_equivalence(ids);
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

Result<void> Reader::add_equivalence(const std::array<std::int64_t, 2>& ids) {
  equivalences_.push_back({ids, false, {}, where()});
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
  if (from.value() == to.value()) {
    ++within_place_;
    return {};
  }
  reference.edge.from = from.value();
  reference.edge.to = to.value();
  graph_.edges.push_back(reference.edge);
  return {};
}

/// Each group of vertices that EQUIV lines join becomes its first vertex in the file, with its start value.
Result<void> Reader::join_places() {
  if (equivalences_.empty()) return {};
  std::vector<std::size_t> place(graph_.vertices.size());
  std::iota(place.begin(), place.end(), 0);
  const auto first_of = [&](std::size_t vertex) {
    while (place[vertex] != vertex) vertex = place[vertex] = place[place[vertex]];
    return vertex;
  };
  for (const Reference& same : equivalences_) {
    const auto one = find(same.ids[0], same.where), other = find(same.ids[1], same.where);
    if (!one) return one.error();
    if (!other) return other.error();
    if (graph_.vertices[one.value()].kind != graph_.vertices[other.value()].kind)
      return Error{ErrorCode::format, "a pose and a landmark cannot be one place", same.where,
                   "EQUIV joins two poses or two landmarks"};
    const std::size_t a = first_of(one.value()), b = first_of(other.value());
    place[std::max(a, b)] = std::min(a, b);
  }
  for (std::size_t v = 0; v < place.size(); ++v) place[v] = first_of(v);
  keep_places(place);
  return {};
}

/// @param place for each vertex the first vertex of its place
void Reader::keep_places(const std::vector<std::size_t>& place) {
  std::vector<GraphVertex> kept;
  std::vector<std::size_t> position(place.size());
  for (std::size_t v = 0; v < place.size(); ++v) {
    if (place[v] == v) {
      position[v] = kept.size();
      kept.push_back(graph_.vertices[v]);
    } else {
      position[v] = position[place[v]];
      graph_.aliases.push_back({graph_.vertices[v].id, position[v]});
    }
    positions_[graph_.vertices[v].id] = position[v];
  }
  graph_.vertices = std::move(kept);
}

Error Reader::no_graph() const {
  const std::string others = skipped_.empty() ? "" : "; other lines: " + list_of(skipped_);
  return {ErrorCode::format, "no vertex and no edge" + others, name_,
          "give a pose graph in g2o or TORO text"};
}

void Reader::note_what_was_left_out() {
  for (const auto& [tag, lines] : skipped_)
    graph_.notes.push_back("skipped " + std::to_string(lines) + " lines \"" + tag + "\"");
  if (!graph_.aliases.empty())
    graph_.notes.push_back("EQUIV: " + std::to_string(graph_.aliases.size()) +
                           " vertex numbers name the place of another vertex, the first: " +
                           std::to_string(graph_.aliases.front().id) + " is " +
                           std::to_string(graph_.vertices[graph_.aliases.front().vertex].id));
  if (within_place_ > 0)
    graph_.notes.push_back("left out " + std::to_string(within_place_) +
                           " edges between two numbers of one place (EQUIV)");
}

Result<PoseGraph> Reader::finish() {
  if (!unusable_.empty())
    return Error{ErrorCode::format, "no planar vertex or edge that can be used: " + list_of(unusable_),
                 first_unusable_, "planar graphs hold VERTEX_SE2, VERTEX_XY, EDGE_SE2, EDGE_SE2_XY"};
  if (graph_.vertices.empty()) place_vertices_of_edges();
  if (graph_.vertices.empty()) return no_graph();
  if (auto joined = join_places(); !joined) return joined.error();
  graph_.edges.reserve(edges_.size());
  for (Reference& reference : edges_)
    if (auto linked = link(reference); !linked) return linked.error();
  for (const Reference& fix : fixes_) {
    const auto vertex = find(fix.ids[0], fix.where);
    if (!vertex) return vertex.error();
    graph_.vertices[vertex.value()].fixed = true;
  }
  note_what_was_left_out();
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
