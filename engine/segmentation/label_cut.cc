#include "engine/segmentation/label_cut.h"

#include <stdexcept>
#include <utility>

// Boykov and Kolmogorov's maximum flow as CGAL ships it. Its own alpha
// expansion cannot be used: up to CGAL 5.5 the flow of one move is not reset
// before the next, so that all moves but the first are lost, and its variants
// on Boost's graphs take quadratic time.
#include <CGAL/boost/graph/Alpha_expansion_MaxFlow_tag.h>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

using Flow = MaxFlow::Graph;

[[noreturn]] void FailFlow(const char* message) {
  throw std::runtime_error(message);
}

// One problem and its labelling so far; at first all faces have label 0.
class Expansion {
 public:
  Expansion(const std::vector<std::vector<double>>& costs,
            const std::vector<FaceLink>& links,
            const std::vector<double>& link_costs)
      : costs_(costs),
        links_(links),
        link_costs_(link_costs),
        labels_(costs.front().size(), 0),
        energy_(CalcEnergy(labels_)) {}

  // Lets every face keep its label or take alpha, whichever is best for all.
  // False when nothing is gained.
  bool Expand(int alpha) {
    Flow flow(FailFlow);
    // A face on the source's side keeps its label and pays its sink weight; one
    // on the sink's side takes alpha and pays its source weight.
    std::vector<Flow::node_id> nodes(labels_.size(), nullptr);
    for (size_t f = 0; f < labels_.size(); ++f) {
      if (labels_[f] == alpha) continue;
      nodes[f] = flow.add_node();
      flow.add_tweights(nodes[f], costs_[alpha][f], costs_[labels_[f]][f]);
    }
    for (size_t i = 0; i < links_.size(); ++i) {
      const auto [a, b] = std::pair(links_[i].face_a, links_[i].face_b);
      const double cost = link_costs_[i];
      if (nodes[a] && nodes[b] && labels_[a] == labels_[b]) {
        flow.add_edge(nodes[a], nodes[b], cost, cost);
      } else if (nodes[a]) {
        // To be paid unless a, and b, take alpha.
        flow.add_tweights(nodes[a], 0.0, cost);
        if (nodes[b]) flow.add_edge(nodes[b], nodes[a], cost, 0.0);
      } else if (nodes[b]) {
        flow.add_tweights(nodes[b], 0.0, cost);
      }
    }
    flow.maxflow();
    std::vector<int> labels = labels_;
    for (size_t f = 0; f < labels.size(); ++f) {
      if (nodes[f] && flow.what_segment(nodes[f]) == Flow::SINK) {
        labels[f] = alpha;
      }
    }
    const double energy = CalcEnergy(labels);
    if (energy >= energy_ * (1.0 - 1e-12)) return false;
    labels_ = std::move(labels);
    energy_ = energy;
    return true;
  }

  const std::vector<int>& labels() const { return labels_; }

 private:
  double CalcEnergy(const std::vector<int>& labels) const {
    double energy = 0.0;
    for (size_t f = 0; f < labels.size(); ++f) energy += costs_[labels[f]][f];
    for (size_t i = 0; i < links_.size(); ++i) {
      if (labels[links_[i].face_a] != labels[links_[i].face_b]) {
        energy += link_costs_[i];
      }
    }
    return energy;
  }

  const std::vector<std::vector<double>>& costs_;
  const std::vector<FaceLink>& links_;
  const std::vector<double>& link_costs_;
  std::vector<int> labels_;
  double energy_;
};

}  // namespace

std::vector<int> CutLabels(const std::vector<std::vector<double>>& costs,
                           const std::vector<FaceLink>& links,
                           const std::vector<double>& link_costs) {
  GRASPDB_EXPECTS(!costs.empty() && links.size() == link_costs.size());
  for (const auto& row : costs) {
    GRASPDB_EXPECTS(row.size() == costs.front().size());
  }
  const int num_labels = static_cast<int>(costs.size());
  Expansion expansion(costs, links, link_costs);
  // Label 1 first: with two labels this one move is the optimum.
  int idle = 0;
  for (int alpha = 1 % num_labels; idle < num_labels;
       alpha = (alpha + 1) % num_labels) {
    idle = expansion.Expand(alpha) ? 1 : idle + 1;
  }
  return expansion.labels();
}

}  // namespace graspdb
