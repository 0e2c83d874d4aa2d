#include "engine/quality/contact_extraction.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace graspdb {
namespace {

// Pieces of a link's surface that contacts are looked for from, metres.
constexpr double kPieceRadius = 0.0008;
// More than the distance field errs by next to a surface, metres.
constexpr double kFieldSlack = 0.0005;

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

  std::vector<Contact> Find() {
    link_.tree.VisitNear(
        [this](const Eigen::Vector3d& p_L) {
          return solid_.field().Calc(X_OL_ * p_L);
        },
        parameters_.tolerance + kFieldSlack,
        [this](const SurfacePatch& patch) { Visit(patch); });
    return std::move(candidates_);
  }

 private:
  // Splits the patch, while it may touch, into pieces.
  void Visit(const SurfacePatch& patch) {
    const auto on_object = solid_.index().FindClosest(
        X_OL_ * patch.p_L, parameters_.tolerance + patch.radius);
    if (!on_object) return;
    if (patch.radius > kPieceRadius) {
      for (const SurfacePatch& half : SplitPatch(patch)) Visit(half);
    } else if (const auto contact = FindContact(*on_object)) {
      candidates_.push_back(*contact);
    }
  }

  // Where link and object are closest around a point of the object: project
  // it to the link, and to the object again.
  std::optional<Contact> FindContact(const ClosestPoint& on_object) const {
    const auto on_link = link_.index.FindClosest(
        X_LO_ * on_object.p_M, parameters_.tolerance + kPieceRadius);
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
    return Contact{link_index_, nearest->p_M, nhat_O, nearest->distance};
  }

  const LinkShape& link_;
  const int link_index_;
  const RigidTransform X_OL_;
  const RigidTransform X_LO_;
  const Solid& solid_;
  const ContactParameters& parameters_;
  std::vector<Contact> candidates_;
};

// The ends of the patch and its widest points on both sides of their line.
std::vector<Contact> ChooseExtremes(const std::vector<Contact>& patch,
                                    double min_separation) {
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

  std::vector<Contact> chosen{first};
  for (const Contact& next : {second, left, right}) {
    const bool apart =
        std::all_of(chosen.begin(), chosen.end(), [&](const Contact& c) {
          return (c.p_O - next.p_O).norm() >= min_separation;
        });
    if (apart) chosen.push_back(next);
  }
  return chosen;
}

// Greedy patches: the smallest gap left leads, and takes all whose normals are
// within the angle of its own.
void AddPatchContacts(std::vector<Contact> candidates,
                      const ContactParameters& parameters,
                      std::vector<Contact>& contacts) {
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const Contact& a, const Contact& b) { return a.gap < b.gap; });
  const double min_cosine = std::cos(parameters.patch_angle);
  while (!candidates.empty()) {
    const Eigen::Vector3d nhat = candidates.front().nhat_O;
    const auto rest = std::stable_partition(
        candidates.begin(), candidates.end(),
        [&](const Contact& c) { return c.nhat_O.dot(nhat) >= min_cosine; });
    const std::vector<Contact> patch(candidates.begin(), rest);
    for (const Contact& c : ChooseExtremes(patch, parameters.min_separation)) {
      contacts.push_back(c);
    }
    candidates.erase(candidates.begin(), rest);
  }
}

}  // namespace

std::vector<Contact> ExtractContacts(const HandShape& hand,
                                     const RigidTransform& X_OH,
                                     const std::vector<RigidTransform>& X_HL,
                                     const Solid& solid,
                                     const ContactParameters& parameters) {
  std::vector<Contact> contacts;
  for (int i = 0; i < hand.model().num_links(); ++i) {
    if (!hand.link(i)) continue;
    AddPatchContacts(
        LinkContacts(*hand.link(i), i, X_OH * X_HL[i], solid, parameters)
            .Find(),
        parameters, contacts);
  }
  return contacts;
}

}  // namespace graspdb
