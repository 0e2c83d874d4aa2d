#include <algorithm>
#include <cmath>

#include "server/ids.h"
#include "server/store/store.h"
#include "server/store/store_impl.h"

namespace graspdb {
namespace {

using store::CheckIdCursor;
using store::CheckPage;
using store::MakePage;
using store::Throw;
using store::Unwrap;

constexpr int kMostAttempts = 3;

constexpr char kJobColumns[] =
    "SELECT id, kind, state, progress, stage, request, result_id, error_code,"
    " error_message, error_hint, error_field, created_at, started_at,"
    " finished_at, deadline FROM jobs ";

StoredJob MakeJob(const Statement& row) {
  StoredJob job;
  job.id = row.Text(0);
  job.kind = Unwrap(ParseJobKind(row.Text(1)));
  job.state = Unwrap(ParseJobState(row.Text(2)));
  job.progress = row.Double(3);
  job.stage = row.Text(4);
  job.request = row.Text(5);
  job.result_id = row.Text(6);
  if (!row.IsNull(7)) {
    job.error = Error{Unwrap(ParseErrorCode(row.Text(7))), row.Text(8),
                      row.Text(9), row.Text(10)};
  }
  job.created_at = row.Text(11);
  job.started_at = row.Text(12);
  job.finished_at = row.Text(13);
  if (!row.IsNull(14)) job.deadline = row.Int(14);
  return job;
}

StoredJob ReadJob(Database& database, const std::string& id) {
  Statement row = database.Prepare(std::string(kJobColumns) + "WHERE id = ?");
  if (!row.Bind(id).Step()) {
    Throw(ErrorCode::kNotFound, "There is no job '" + id + "'.",
          "GET /v1/jobs lists them", "id");
  }
  return MakeJob(row);
}

std::optional<StoredJob> FindJobByKey(Database& database,
                                      const std::string& key) {
  if (key.empty()) return std::nullopt;
  Statement row =
      database.Prepare(std::string(kJobColumns) + "WHERE idempotency_key = ?");
  if (!row.Bind(key).Step()) return std::nullopt;
  return MakeJob(row);
}

// The oldest queued job; empty when there is none.
std::string FindQueued(Database& database, bool slow) {
  Statement row = database.Prepare(
      "SELECT id FROM jobs WHERE state = 'queued' AND slow = ?"
      " ORDER BY id LIMIT 1");
  return row.Bind(slow).Step() ? row.Text(0) : std::string();
}

// Whether a job was submitted with that payload, which may be gone.
bool CarriesPayload(Database& database, const std::string& id,
                    const std::string& payload_sha256) {
  Statement row = database.Prepare(
      "SELECT 1 FROM jobs WHERE id = ? AND"
      " (payload_sha256 IS NULL OR payload_sha256 = ?)");
  return row.Bind(id, payload_sha256).Step();
}

// Those that a statement has just changed, in the order of their ids.
std::vector<StoredJob> ReadJobs(Database& database, Statement& changed) {
  std::vector<std::string> ids;
  while (changed.Step()) ids.push_back(changed.Text(0));
  std::sort(ids.begin(), ids.end());
  std::vector<StoredJob> jobs;
  for (const std::string& id : ids) jobs.push_back(ReadJob(database, id));
  return jobs;
}

// Rows of jobs are no archive: what they made is stored elsewhere.
void ForgetOldJobs(Database& database) {
  constexpr int64_t kWeek = int64_t{7} * 24 * 3600 * 1000;
  const int64_t week_ago = CalcUnixMilliseconds() - kWeek;
  database
      .Prepare(
          "DELETE FROM jobs WHERE id < ? AND finished_at < ?"
          " AND state IN ('succeeded', 'failed', 'cancelled')")
      .Bind(MakeUuidBound(week_ago), FormatTime(week_ago))
      .Run();
}

int64_t CountQueued(Database& database, bool slow) {
  Statement row = database.Prepare(
      "SELECT count(*) FROM jobs WHERE state = 'queued' AND slow = ?");
  row.Bind(slow).Step();
  return row.Int(0);
}

}  // namespace

Result<StoredJob> Store::InsertJob(JobKind kind, bool slow,
                                   const std::string& request,
                                   const std::string& payload,
                                   const JobTerms& terms, int64_t max_queued) {
  const std::string payload_sha256 = CalcSha256(payload);
  return impl_->Write([&](Database& database) {
    ForgetOldJobs(database);
    if (auto known = FindJobByKey(database, terms.idempotency_key)) {
      if (known->kind != kind || known->request != request ||
          !CarriesPayload(database, known->id, payload_sha256)) {
        Throw(ErrorCode::kKeyReused,
              "The Idempotency-Key was used for another request.",
              "use a new key for a new request", "Idempotency-Key");
      }
      return *known;
    }
    if (CountQueued(database, slow) >= max_queued) {
      Throw(ErrorCode::kOverloaded,
            std::to_string(max_queued) + " jobs are waiting already.",
            "send the request again when some have ended; GET /v1/jobs lists "
            "them");
    }
    const std::string id = MakeUuid();
    const int64_t now = CalcUnixMilliseconds();
    std::optional<int64_t> deadline;
    if (terms.deadline) deadline = now + std::llround(1e3 * *terms.deadline);
    database
        .Prepare(
            "INSERT INTO jobs (id, kind, state, slow, request, idempotency_key,"
            " progress, stage, created_at, deadline, payload_sha256, payload)"
            " VALUES (?, ?, 'queued', ?, ?, ?, 0, '', ?, ?, ?, ?)")
        .Bind(id, ToString(kind), slow, request)
        .BindTextOrNull(terms.idempotency_key)
        .Bind(FormatTime(now), deadline, payload_sha256)
        .BindBlob(payload)
        .Run();
    return ReadJob(database, id);
  });
}

Result<StoredJob> Store::FindJob(const std::string& id) const {
  return impl_->Read([&](Database& database) { return ReadJob(database, id); });
}

Result<std::vector<StoredJob>> Store::FailOverdueJobs() {
  const int64_t now = CalcUnixMilliseconds();
  constexpr const char* kOverdue = " WHERE state = 'queued' AND deadline <= ?";
  // Most calls find nothing and need no write.
  const Result<bool> some = impl_->Read([&](Database& database) {
    Statement row =
        database.Prepare(std::string("SELECT 1 FROM jobs") + kOverdue);
    return row.Bind(now).Step();
  });
  if (!some) return some.error();
  if (!*some) return std::vector<StoredJob>();
  return impl_->Write([&](Database& database) {
    const Error error = MakeTimedOut();
    Statement update = database.Prepare(
        std::string(
            "UPDATE jobs SET state = 'failed', error_code = ?,"
            " error_message = ?, error_hint = ?, error_field = ?,"
            " finished_at = ?, idempotency_key = NULL, payload = NULL") +
        kOverdue + " RETURNING id");
    update.Bind(ToString(error.code), error.message, error.hint, error.field,
                FormatNow(), now);
    return ReadJobs(database, update);
  });
}

Result<Page<StoredJob>> Store::ListJobs(std::optional<JobState> state,
                                        const PageRequest& page) const {
  return impl_->Read([&](Database& database) {
    CheckPage(page);
    CheckIdCursor(page);
    std::string where = "WHERE (?1 = '' OR id < ?1)";
    if (state) where += " AND state = ?3";
    Statement rows =
        database.Prepare(kJobColumns + where + " ORDER BY id DESC LIMIT ?2");
    rows.Bind(page.cursor, page.limit + 1);
    if (state) rows.Bind(ToString(*state));
    std::vector<StoredJob> jobs;
    while (rows.Step()) jobs.push_back(MakeJob(rows));
    return MakePage(std::move(jobs), page.limit,
                    [](const StoredJob& last) { return last.id; });
  });
}

Result<std::map<std::pair<JobKind, JobState>, int64_t>> Store::CountJobs()
    const {
  return impl_->Read([&](Database& database) {
    std::map<std::pair<JobKind, JobState>, int64_t> counts;
    Statement rows = database.Prepare(
        "SELECT kind, state, count(*) FROM jobs GROUP BY kind, state");
    while (rows.Step()) {
      counts[{Unwrap(ParseJobKind(rows.Text(0))),
              Unwrap(ParseJobState(rows.Text(1)))}] = rows.Int(2);
    }
    return counts;
  });
}

Result<std::string> Store::ReadJobPayload(const std::string& id) const {
  return impl_->Read([&](Database& database) {
    Statement row = database.Prepare("SELECT payload FROM jobs WHERE id = ?");
    row.Bind(id).Step();
    return row.Blob(0);
  });
}

Result<std::optional<StoredJob>> Store::ClaimJob(bool slow) {
  // Most calls find nothing and need no write.
  const Result<std::string> queued = impl_->Read(
      [&](Database& database) { return FindQueued(database, slow); });
  if (!queued) return queued.error();
  if (queued->empty()) return std::optional<StoredJob>();
  return impl_->Write([&](Database& database) -> std::optional<StoredJob> {
    const std::string id = FindQueued(database, slow);
    if (id.empty()) return std::nullopt;
    database
        .Prepare(
            "UPDATE jobs SET state = 'running', started_at = ?, progress = 0,"
            " attempts = attempts + 1 WHERE id = ?")
        .Bind(FormatNow(), id)
        .Run();
    return ReadJob(database, id);
  });
}

Result<StoredJob> Store::FinishJob(const StoredJob& job) {
  GRASPDB_EXPECTS(job.Finished());
  return impl_->Write([&](Database& database) {
    Statement update = database.Prepare(
        "UPDATE jobs SET state = ?, progress = ?, stage = ?, result_id = ?,"
        " error_code = ?, error_message = ?, error_hint = ?, error_field = ?,"
        " finished_at = ?, payload = NULL, idempotency_key ="
        " CASE WHEN ? THEN NULL ELSE idempotency_key END"
        " WHERE id = ? AND state IN ('queued', 'running')");
    update.Bind(ToString(job.state), job.progress, job.stage)
        .BindTextOrNull(job.result_id);
    if (job.error) {
      update.Bind(ToString(job.error->code), job.error->message,
                  job.error->hint, job.error->field);
    } else {
      for (int i = 0; i < 4; ++i) update.BindTextOrNull("");
    }
    const bool missed =
        job.error && job.error->code == ErrorCode::kDeadlineExceeded;
    update.Bind(FormatNow(), missed, job.id).Run();
    return ReadJob(database, job.id);
  });
}

Result<RequeuedJobs> Store::RequeueRunningJobs(bool crashed) {
  return impl_->Write([&](Database& database) {
    RequeuedJobs jobs;
    if (crashed) {
      Statement update = database.Prepare(
          "UPDATE jobs SET state = 'failed', error_code = 'internal',"
          " error_message = 'The server died three times over it.',"
          " finished_at = ?, payload = NULL"
          " WHERE state = 'running' AND attempts >= ? RETURNING id");
      update.Bind(FormatNow(), kMostAttempts);
      jobs.given_up = ReadJobs(database, update);
    }
    database
        .Prepare(
            "UPDATE jobs SET state = 'queued', progress = 0, stage = '',"
            " started_at = NULL, attempts = attempts - ?"
            " WHERE state = 'running'")
        .Bind(crashed ? 0 : 1)
        .Run();
    jobs.num_queued = static_cast<int>(database.Changes());
    return jobs;
  });
}

}  // namespace graspdb
