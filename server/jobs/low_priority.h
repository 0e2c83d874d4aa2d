#pragma once

namespace graspdb {

/** From now on the calling thread, and the threads that it starts, give way to
 those that answer requests: on a machine whose cores are all busy learning,
 queries stay fast. */
void LowerThreadPriority();

/** Has the threads started that help `threads` to compute (0: as many as there
 are cores), so that they have the calling thread's priority, whoever computes
 first.
 */
void StartHelperThreads(int threads);

}  // namespace graspdb
