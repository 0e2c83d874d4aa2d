#include "server/records.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/ids.h"

namespace graspdb {
namespace {

// Every enumerator of a type by name; the names are those of ToString().
template <class Enum, size_t N>
Result<Enum> Parse(const std::string& text, const char* what,
                   const std::array<Enum, N>& all) {
  std::string known;
  for (const Enum value : all) {
    if (text == ToString(value)) return value;
    known += (known.empty() ? "" : ", ") + std::string(ToString(value));
  }
  return Error{ErrorCode::kInvalidArgument,
               "'" + text + "' is not a " + what + ".", "one of " + known,
               what};
}

}  // namespace

std::map<std::string, double> NameClearances(
    const std::vector<double>& clearances,
    const std::vector<std::string>& labels, const std::string& held) {
  std::map<std::string, double> named;
  for (size_t i = 0; i < clearances.size() && i < labels.size(); ++i) {
    if (labels[i] == held || !std::isfinite(clearances[i])) continue;
    named[labels[i]] = clearances[i];
  }
  return named;
}

std::string MakeCoreStage(const std::string& stage, const std::string& label) {
  return stage + " of " + label + ", core";
}

std::string MakeGraspId(const std::string& origin_id, GraspStage stage,
                        int index) {
  return MakeContentId("grasp " + origin_id + " " + ToString(stage) + " " +
                       std::to_string(index));
}

const char* ToString(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidArgument:
      return "invalid_argument";
    case ErrorCode::kUnusableInput:
      return "unusable_input";
    case ErrorCode::kTooLarge:
      return "too_large";
    case ErrorCode::kNotFound:
      return "not_found";
    case ErrorCode::kConflict:
      return "conflict";
    case ErrorCode::kNotInCategory:
      return "not_in_category";
    case ErrorCode::kCancelled:
      return "cancelled";
    case ErrorCode::kDeadlineExceeded:
      return "deadline_exceeded";
    case ErrorCode::kStorage:
      return "storage";
    case ErrorCode::kOverloaded:
      return "overloaded";
    case ErrorCode::kKeyReused:
      return "key_reused";
    case ErrorCode::kNotImplemented:
      return "not_implemented";
    case ErrorCode::kInternal:
      return "internal";
  }
  return "";
}

const char* ToString(ObjectRole role) {
  return role == ObjectRole::kExample ? "example" : "novel";
}

const char* ToString(GraspStage stage) {
  switch (stage) {
    case GraspStage::kLearned:
      return "learned";
    case GraspStage::kTransfer:
      return "transfer";
    case GraspStage::kAssembly:
      return "assembly";
  }
  return "";
}

const char* ToString(JobKind kind) {
  switch (kind) {
    case JobKind::kImport:
      return "import";
    case JobKind::kLearn:
      return "learn";
    case JobKind::kTransfer:
      return "transfer";
    case JobKind::kSegment:
      return "segment";
    case JobKind::kVerify:
      return "verify";
  }
  return "";
}

const char* ToString(JobState state) {
  switch (state) {
    case JobState::kQueued:
      return "queued";
    case JobState::kRunning:
      return "running";
    case JobState::kSucceeded:
      return "succeeded";
    case JobState::kFailed:
      return "failed";
    case JobState::kCancelled:
      return "cancelled";
  }
  return "";
}

const char* ToString(SegmentationVerdict verdict) {
  switch (verdict) {
    case SegmentationVerdict::kMatched:
      return "matched";
    case SegmentationVerdict::kUnsure:
      return "unsure";
    case SegmentationVerdict::kForeign:
      return "foreign";
  }
  return "";
}

Error MakeTimedOut() {
  return {ErrorCode::kDeadlineExceeded,
          "The deadline passed before the work was done.",
          "allow more time with deadline; GET /v1/jobs tells what else waits",
          "deadline"};
}

Result<ErrorCode> ParseErrorCode(const std::string& text) {
  return Parse(text, "code",
               std::array{ErrorCode::kInvalidArgument,
                          ErrorCode::kUnusableInput, ErrorCode::kTooLarge,
                          ErrorCode::kNotFound, ErrorCode::kConflict,
                          ErrorCode::kNotInCategory, ErrorCode::kCancelled,
                          ErrorCode::kDeadlineExceeded, ErrorCode::kStorage,
                          ErrorCode::kOverloaded, ErrorCode::kKeyReused,
                          ErrorCode::kNotImplemented, ErrorCode::kInternal});
}

Result<ObjectRole> ParseObjectRole(const std::string& text) {
  return Parse(text, "role",
               std::array{ObjectRole::kExample, ObjectRole::kNovel});
}

Result<GraspStage> ParseGraspStage(const std::string& text) {
  return Parse(text, "stage",
               std::array{GraspStage::kLearned, GraspStage::kTransfer,
                          GraspStage::kAssembly});
}

Result<JobKind> ParseJobKind(const std::string& text) {
  return Parse(text, "kind", kJobKinds);
}

Result<JobState> ParseJobState(const std::string& text) {
  return Parse(
      text, "state",
      std::array{JobState::kQueued, JobState::kRunning, JobState::kSucceeded,
                 JobState::kFailed, JobState::kCancelled});
}

Result<TransferOutcome> ParseTransferOutcome(const std::string& text) {
  return Parse(
      text, "outcome",
      std::array{TransferOutcome::kSucceeded,
                 TransferOutcome::kNoCorrespondence,
                 TransferOutcome::kNoContact, TransferOutcome::kUnstable,
                 TransferOutcome::kFingerCollision,
                 TransferOutcome::kPalmCollision, TransferOutcome::kTooFar,
                 TransferOutcome::kUnreachable, TransferOutcome::kNotKeptFree});
}

Result<double> ParseUnits(const std::string& units) {
  if (units == "m") return 1.0;
  if (units == "mm") return 0.001;
  if (units == "cm") return 0.01;
  if (units == "in") return 0.0254;
  return Error{ErrorCode::kInvalidArgument,
               "'" + units + "' is not a unit of length.",
               "one of m, mm, cm, in", "units"};
}

}  // namespace graspdb
