#pragma once

namespace graspdb {

/** The program: `graspdb SUBCOMMAND …`. Results go to standard output, all else
 to standard error.
 @returns the exit status: 0 on success, 1 when a check found damage, 2 with one
   line of explanation otherwise. */
int RunCommandLine(int argc, const char* const* argv);

}  // namespace graspdb
