#include <map>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "common/config/config_tree.h"
#include "common/config/fields.h"

namespace windhover {
namespace {

constexpr std::size_t kMaxDepth = 32;
constexpr std::size_t kMaxNodes = 100000;

// Builds a ConfigNode from the parser's events. The parser's own tree would lose repeated keys
// and the places of keys, and would let aliases multiply without bound.
class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const ConfigSource& source)
      : source_(std::make_shared<const ConfigSource>(source)) {
    root_.where.source = source_;
  }

  ConfigNode TakeRoot() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    Add(Make(ConfigNode::Kind::kNothing, mark), anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto it = anchors_.find(anchor);
    if (it == anchors_.end()) Refuse(mark, "must not contain itself");
    Count(it->second.second, mark);
    Add(it->second.first, YAML::NullAnchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    ConfigNode node = Make(ConfigNode::Kind::kScalar, mark);
    node.scalar = value;
    node.quoted = tag == "!";
    Add(std::move(node), anchor);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    Open(ConfigNode::Kind::kList, mark, anchor);
  }
  void OnSequenceEnd() override { Close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    Open(ConfigNode::Kind::kMap, mark, anchor);
  }
  void OnMapEnd() override { Close(); }

 private:
  // A list or map whose end has not come, and the key that waits for its value.
  struct Level {
    ConfigNode node;
    YAML::anchor_t anchor;
    std::size_t n_nodes_before;
    std::optional<ConfigNode::Entry> pending;
  };

  SourceLocation At(const YAML::Mark& mark) const {
    return {source_, mark.line + 1, mark.column + 1};
  }
  [[noreturn]] void Refuse(const YAML::Mark& mark, const std::string& must) const {
    throw ConfigError(fmt::format("{}: {}", At(mark).ToString(), must));
  }
  void Count(std::size_t n, const YAML::Mark& mark) {
    n_nodes_ += n;
    if (n_nodes_ > kMaxNodes) Refuse(mark, fmt::format("must have at most {} values", kMaxNodes));
  }
  ConfigNode Make(ConfigNode::Kind kind, const YAML::Mark& mark) {
    Count(1, mark);
    ConfigNode node;
    node.kind = kind;
    node.where = At(mark);
    return node;
  }
  void Open(ConfigNode::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (levels_.size() >= kMaxDepth) {
      Refuse(mark, fmt::format("must be nested at most {} levels deep", kMaxDepth));
    }
    const std::size_t before = n_nodes_;
    levels_.push_back({Make(kind, mark), anchor, before, std::nullopt});
  }
  void Close() {
    Level level = std::move(levels_.back());
    levels_.pop_back();
    Add(std::move(level.node), level.anchor, n_nodes_ - level.n_nodes_before);
  }
  void Add(ConfigNode node, YAML::anchor_t anchor, std::size_t n_nodes = 1) {
    if (anchor != YAML::NullAnchor) anchors_[anchor] = {node, n_nodes};
    if (levels_.empty()) {
      root_ = std::move(node);
    } else if (Level& level = levels_.back(); level.node.IsList()) {
      level.node.items.push_back(std::move(node));
    } else if (level.pending) {
      level.pending->value = std::move(node);
      level.node.entries.push_back(*std::exchange(level.pending, std::nullopt));
    } else {
      level.pending = ConfigNode::Entry{KeyText(node), node.where, {}};
    }
  }
  static std::string KeyText(const ConfigNode& node) {
    if (node.IsScalar()) return node.scalar;
    if (node.kind == ConfigNode::Kind::kNothing) return "";
    throw ConfigError(
        fmt::format("{}: must be text as a key (found {})", node.where.ToString(), node.Found()));
  }

  std::shared_ptr<const ConfigSource> source_;
  ConfigNode root_;
  std::vector<Level> levels_;
  std::map<YAML::anchor_t, std::pair<ConfigNode, std::size_t>> anchors_;
  std::size_t n_nodes_ = 0;
};

}  // namespace

ConfigNode ParseYaml(const std::string& text, const ConfigSource& source) {
  TreeBuilder builder(source);
  std::istringstream in(text);
  try {
    YAML::Parser parser(in);
    parser.HandleNextDocument(builder);
    ConfigNode root = builder.TakeRoot();
    TreeBuilder second(source);
    if (parser.HandleNextDocument(second)) {
      throw ConfigError(fmt::format("{}: must be one YAML document (found more)", source.name));
    }
    return root;
  } catch (const YAML::Exception& error) {
    throw ConfigError(fmt::format("{}:{}:{}: must be YAML (found: {})", source.name,
                                  error.mark.line + 1, error.mark.column + 1, error.msg));
  }
}

}  // namespace windhover
