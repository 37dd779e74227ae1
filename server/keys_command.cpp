#include "keys_command.h"

#include <ctime>
#include <iomanip>
#include <iostream>
#include <memory>

#include "supple/access/duration.h"
#include "supple/access/key_file.h"

namespace supple {
namespace {

std::int64_t now() { return std::time(nullptr); }

/// Prints the token alone to standard output, for scripts, and a description of it to standard error.
void print_token(const access::Token& token, const std::string& about) {
  std::cerr << about << " It is shown this once; a running server knows it within a second.\n";
  std::cout << access::token_text(token) << std::endl;
}

void add_add_command(CLI::App& keys, const ServerOptions& options) {
  struct Arguments {
    access::NewKey key;
    std::string scopes;
    std::string expires;
  };
  const auto arguments = std::make_shared<Arguments>();
  auto* const command = keys.add_subcommand("add", "Makes a key and prints it");
  command->fallthrough();
  command->add_option("--name", arguments->key.name, "What or whom it is for")->required();
  command
      ->add_option("--scopes", arguments->scopes,
                   "What it may do, separated by commas: read what it owns, compute (and store, and delete what it "
                   "owns), admin (all of this with what any key owns)")
      ->required();
  command->add_option("--expires", arguments->expires,
                      "How long it is accepted: 90d, 24h, 30m or 45s; without it for ever");
  command
      ->add_option("--rate", arguments->key.requests_per_minute,
                   "Requests a minute, all of which may come at once after a pause; without it there is no limit")
      ->default_str("")
      ->check(CLI::Range(1, 1'000'000));
  command
      ->add_option(
          "--max-waiting-jobs", arguments->key.max_waiting_jobs,
          "Jobs that may wait for a worker, and as many in the background; without it as many as --max-queue says")
      ->default_str("")
      ->check(CLI::Range(1, 1'000'000));
  command
      ->add_option(
          "--max-stored", arguments->key.max_stored,
          "Bytes of the meshes, results and requests of jobs that it owns, 500MB for example; where they would "
          "be more, its oldest results go first. Without it there is no limit but that of --max-store")
      ->default_str("")
      ->transform(CLI::AsSizeValue(false))
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 60));
  command->callback([arguments, &options] {
    arguments->key.scopes = access::parse_scopes(arguments->scopes);
    if (!arguments->expires.empty()) arguments->key.expires_in = access::parse_duration(arguments->expires);
    access::Token token;
    options.key_file().change([&](auto& all) { token = access::add_key(all, arguments->key, now()); });
    print_token(token, "Key " + token.id + " (" + arguments->key.name + ") with " +
                           access::scopes_text(arguments->key.scopes) + ".");
  });
}

void list_keys(const ServerOptions& options) {
  const auto or_never = [](std::int64_t time) { return time ? access::time_text(time) : std::string("never"); };
  const auto or_none = [](std::int64_t limit) { return limit ? std::to_string(limit) : std::string("-"); };
  const auto row = [](const auto& id, const auto& scopes, const auto& created, const auto& expires, const auto& rate,
                      const auto& jobs, const auto& stored, const auto& name) {
    constexpr int id_width = 14;
    constexpr int scopes_width = 20;
    constexpr int time_width = 22;
    constexpr int count_width = 10;
    constexpr int bytes_width = 16;
    std::cout << std::left << std::setw(id_width) << id << std::setw(scopes_width) << scopes << std::setw(time_width)
              << created << std::setw(time_width) << expires << std::setw(count_width) << rate << std::setw(count_width)
              << jobs << std::setw(bytes_width) << stored << name << '\n';
  };
  row("ID", "SCOPES", "CREATED", "EXPIRES", "RATE", "WAITING", "STORED", "NAME");
  for (const auto& key : options.key_file().read()) {
    auto name = key.name;
    if (key.previous && now() < key.previous_until)
      name += " (old secret until " + access::time_text(key.previous_until) + ")";
    row(key.id, access::scopes_text(key.scopes), access::time_text(key.created), or_never(key.expires),
        or_none(key.requests_per_minute), or_none(key.max_waiting_jobs), or_none(key.max_stored), name);
  }
}

void add_rotate_command(CLI::App& keys, const ServerOptions& options) {
  struct Arguments {
    std::string id;
    std::string overlap = "24h";
  };
  const auto arguments = std::make_shared<Arguments>();
  auto* const command =
      keys.add_subcommand("rotate", "Gives a key a new secret, which it prints; what it owns stays its");
  command->fallthrough();
  command->add_option("ID", arguments->id, "The key's id, which keys list shows")->required();
  command->add_option("--overlap", arguments->overlap, "How long the old secret is accepted; 0 ends it at once")
      ->capture_default_str();
  command->callback([arguments, &options] {
    const auto overlap = arguments->overlap == "0" ? 0 : access::parse_duration(arguments->overlap);
    access::Token token;
    options.key_file().change([&](auto& all) { token = access::rotate_key(all, arguments->id, overlap, now()); });
    print_token(token, "Key " + token.id + " has a new secret; the old one ends " +
                           (overlap ? access::time_text(now() + overlap) : std::string("now")) + ".");
  });
}

void add_revoke_command(CLI::App& keys, const ServerOptions& options) {
  const auto id = std::make_shared<std::string>();
  auto* const command = keys.add_subcommand(
      "revoke", "Ends a key for good; what it owns stays, for keys with the scope admin to see and delete");
  command->fallthrough();
  command->add_option("ID", *id, "The key's id, which keys list shows")->required();
  command->callback([id, &options] {
    options.key_file().change([&](auto& all) { access::revoke_key(all, *id); });
    std::cerr << "Key " << *id << " is revoked; a running server refuses it within a second.\n";
  });
}

}  // namespace

void add_keys_commands(CLI::App& app, const ServerOptions& options) {
  auto* const keys =
      app.add_subcommand("keys", "Makes, lists and ends the keys of the file that --keys or --data name");
  keys->fallthrough();
  keys->require_subcommand(1);
  add_add_command(*keys, options);
  keys->add_subcommand("list", "Shows all keys, without their secrets, which nobody has")
      ->fallthrough()
      ->callback([&options] { list_keys(options); });
  add_rotate_command(*keys, options);
  add_revoke_command(*keys, options);
}

}  // namespace supple
