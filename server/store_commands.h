#pragma once

namespace supple {

/// "supple-server check --data D [--database U] [--repair]": prints what is wrong with a data folder. Status 0 where
/// nothing is, otherwise 1.
int check_command(int argc, char** argv);

/// "supple-server backup --data D [--database U] --to F": copies a data folder, also while a server uses it. Status 1
/// where something in it is damaged or missing.
int backup_command(int argc, char** argv);

/// "supple-server restore --from F --data D [--database U] [--replace]": makes a data folder of a backup. Status as of
/// backup.
int restore_command(int argc, char** argv);

}  // namespace supple
