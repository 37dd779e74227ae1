#pragma once

namespace supple {

/// Runs "supple-server check --data D [--database U] [--repair]", which prints the faults of a data folder. The status
/// is 0 if there are none, otherwise 1.
int check_command(int argc, char** argv);

/// Runs "supple-server backup --data D [--database U] --to F", which copies a data folder, even while a server uses it.
/// The status is 1 if something in it is damaged or missing, otherwise 0.
int backup_command(int argc, char** argv);

/// Runs "supple-server restore --from F --data D [--database U] [--replace]", which makes a data folder of a backup.
/// The status has the same meaning as for a backup.
int restore_command(int argc, char** argv);

}  // namespace supple
