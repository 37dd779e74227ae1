#include <memory>

#include "command_tree.h"
#include "commands.h"
#include "completion.h"
#include "manual_page.h"

namespace supple::cli {

void add_program_commands(CLI::App& program, const std::string& version) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* completion =
      program.add_subcommand("completion", "Print a script by which a shell completes command lines of supple");
  completion->add_option("shell", *shell, "Shell")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
  completion->footer(
      "Examples:\n  source <(supple completion bash)\n  supple completion zsh > ~/.zfunc/_supple\n"
      "  supple completion fish > ~/.config/fish/completions/supple.fish");
  completion->callback([&program, shell] {
    write_file("-", *shell == "bash"  ? bash_completion(program)
                    : *shell == "zsh" ? zsh_completion(program)
                                      : fish_completion(program));
  });
  CLI::App* man = program.add_subcommand("man", "Print the manual page of supple in roff");
  man->footer("Examples:\n  supple man | man -l -\n  supple man > ~/.local/share/man/man1/supple.1");
  man->callback([&program, version] { write_file("-", manual_page(program, version)); });
}

}  // namespace supple::cli
