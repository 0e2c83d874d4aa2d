#include "engine/quality/contact_extraction.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace graspdb {
namespace {

// Between probes of the link, and where the distance field errs, the surfaces
// may come closer than the field says at the probes, metres.
constexpr double kSlack = 0.0007;
// A patch is found to half a millimetre though probes are two apart, metres.
constexpr double kOutwardSteps[] = {0.0015, 0.001, 0.0005};

// Finds the contacts of one link.
class LinkContacts {
 public:
  LinkContacts(const LinkShape& link, int link_index,
               const RigidTransform& X_OL, const Solid& solid,
               const ContactParameters& parameters)
      : link_(link),
        link_index_(link_index),
        X_OL_(X_OL),
        X_LO_(X_OL.Inverse()),
        solid_(solid),
        parameters_(parameters) {}

  // Greedy patches: the smallest gap left leads, and takes all whose normals
  // are within the angle of its own.
  void AddTo(std::vector<Contact>& contacts) const {
    std::vector<Contact> candidates = FindCandidates();
    std::stable_sort(
        candidates.begin(), candidates.end(),
        [](const Contact& a, const Contact& b) { return a.gap < b.gap; });
    const double min_cosine = std::cos(parameters_.patch_angle);
    while (!candidates.empty()) {
      const Eigen::Vector3d nhat = candidates.front().nhat_O;
      const auto rest = std::stable_partition(
          candidates.begin(), candidates.end(),
          [&](const Contact& c) { return c.nhat_O.dot(nhat) >= min_cosine; });
      AddExtremes({candidates.begin(), rest}, contacts);
      candidates.erase(candidates.begin(), rest);
    }
  }

 private:
  std::vector<Contact> FindCandidates() const {
    std::vector<Contact> candidates;
    link_.tree.VisitNear(PosedField(solid_.field(), X_OL_),
                         parameters_.tolerance + kSlack,
                         [&](const Eigen::Vector3d& p_L, double /*distance*/) {
                           const auto contact = FindContact(X_OL_ * p_L);
                           if (contact) candidates.push_back(*contact);
                         });
    return candidates;
  }

  // Where link and object are closest around a point: project it to the object,
  // that to the link, and to the object again.
  std::optional<Contact> FindContact(const Eigen::Vector3d& p_O) const {
    const double reach = parameters_.tolerance + 2.0 * kSlack;
    const auto on_object = solid_.index().FindClosest(p_O, reach);
    if (!on_object) return std::nullopt;
    const auto on_link = link_.index.FindClosest(X_LO_ * on_object->p_M, reach);
    if (!on_link) return std::nullopt;
    const auto nearest =
        solid_.index().FindClosest(X_OL_ * on_link->p_M, parameters_.tolerance);
    if (!nearest || solid_.is_cap(nearest->face)) return std::nullopt;
    const Eigen::Vector3d nhat_link_O = X_OL_.rotation * on_link->pseudonormal;
    if (nhat_link_O.dot(nearest->pseudonormal) >
        -std::cos(parameters_.max_normal_angle)) {
      return std::nullopt;
    }
    // On an edge of the object, the link's face says where the contact pushes.
    const Eigen::Vector3d nhat_O = !nearest->on_face && on_link->on_face
                                       ? Eigen::Vector3d(-nhat_link_O)
                                       : nearest->pseudonormal;
    return Contact{link_index_, nearest->p_M, nhat_O, nearest->distance,
                   solid_.is_seen(nearest->p_M)};
  }

  // The ends of the patch and its widest points on both sides of their line.
  void AddExtremes(const std::vector<Contact>& patch,
                   std::vector<Contact>& contacts) const {
    const auto farthest = [&patch](const auto& score) {
      return *std::max_element(patch.begin(), patch.end(),
                               [&score](const Contact& a, const Contact& b) {
                                 return score(a) < score(b);
                               });
    };
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Contact& c : patch) middle += c.p_O / patch.size();
    const Contact first = farthest(
        [&](const Contact& c) { return (c.p_O - middle).squaredNorm(); });
    const Contact second = farthest(
        [&](const Contact& c) { return (c.p_O - first.p_O).squaredNorm(); });
    const Eigen::Vector3d across =
        first.nhat_O.cross(second.p_O - first.p_O).normalized();
    const auto side = [&](const Contact& c) {
      return across.dot(c.p_O - first.p_O);
    };
    const Contact left = farthest(side);
    const Contact right = farthest([&](const Contact& c) { return -side(c); });

    const auto mine = static_cast<std::ptrdiff_t>(contacts.size());
    for (const Contact& found : {first, second, left, right}) {
      const Contact next = PushOutwards(found, middle, patch.front());
      const bool apart = std::all_of(
          contacts.begin() + mine, contacts.end(), [&](const Contact& c) {
            return (c.p_O - next.p_O).norm() >= parameters_.min_separation;
          });
      if (apart) contacts.push_back(next);
    }
  }

  // The patch ends somewhere between this probe and the next one outwards.
  Contact PushOutwards(const Contact& extreme, const Eigen::Vector3d& middle,
                       const Contact& leader) const {
    const Eigen::Vector3d out = (extreme.p_O - middle).normalized();
    const double min_cosine = std::cos(parameters_.patch_angle);
    for (const double step : kOutwardSteps) {
      const auto next = FindContact(extreme.p_O + step * out);
      if (next && next->nhat_O.dot(leader.nhat_O) >= min_cosine) return *next;
    }
    return extreme;
  }

  const LinkShape& link_;
  const int link_index_;
  const RigidTransform X_OL_;
  const RigidTransform X_LO_;
  const Solid& solid_;
  const ContactParameters& parameters_;
};

}  // namespace

std::vector<Contact> ExtractContacts(const HandShape& hand,
                                     const RigidTransform& X_OH,
                                     const std::vector<RigidTransform>& X_HL,
                                     const Solid& solid,
                                     const ContactParameters& parameters) {
  std::vector<Contact> contacts;
  for (int i = 0; i < hand.model().num_links(); ++i) {
    if (!hand.link(i)) continue;
    LinkContacts(*hand.link(i), i, X_OH * X_HL[i], solid, parameters)
        .AddTo(contacts);
  }
  return contacts;
}

}  // namespace graspdb
