#include "editor/cli/help_pages.h"

#include <fmt/format.h>

#include <algorithm>

namespace rebake {

namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

std::string joined(const std::vector<std::string>& parts, const std::string& between) {
  std::string out;
  for (const std::string& part : parts) out += (out.empty() ? "" : between) + part;
  return out;
}

bool is_positional(const OptionHelp& option) { return !option.names.starts_with('-'); }

// "-o" and "--out"; none for a positional argument.
std::vector<std::string> flags_of(const OptionHelp& option) {
  return is_positional(option) ? std::vector<std::string>() : split(option.names, ',');
}

std::vector<std::string> all_flags(const SubcommandHelp& subcommand) {
  std::vector<std::string> flags{"--help"};
  for (const OptionHelp& option : subcommand.options)
    for (const std::string& flag : flags_of(option)) flags.push_back(flag);
  return flags;
}

std::vector<std::string> names_of(const std::vector<SubcommandHelp>& subcommands) {
  std::vector<std::string> names;
  for (const SubcommandHelp& subcommand : subcommands) names.push_back(subcommand.name);
  return names;
}

// Text in troff: dashes stay dashes, backslashes are no commands, and no line begins with a request.
std::string troff(const std::string& text) {
  std::string out;
  for (const std::string& line : split(text, '\n')) {
    if (!out.empty()) out += "\n.br\n";
    if (line.starts_with('.') || line.starts_with('\'')) out += "\\&";
    for (const char c : line) out += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
  }
  return out;
}

std::string single_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

// What zsh's _arguments takes as a description: brackets and colons have a meaning there.
std::string zsh_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

// "message:action" of zsh's _arguments for a value: the allowed words, else files.
std::string zsh_value(const OptionHelp& option) {
  const std::string what = zsh_text(option.hint.empty() ? option.names : option.hint);
  return option.words.empty() ? what + ":_files" : fmt::format("{}:({})", what, joined(option.words, " "));
}

}  // namespace

std::string manual_page(const std::vector<SubcommandHelp>& subcommands, const std::string& version) {
  std::string out = fmt::format(
      ".TH REBAKE 1 \"\" \"{}\" \"User Commands\"\n"
      ".SH NAME\nrebake \\- editor and composer for baked NeRF scenes (MobileNeRF format)\n"
      ".SH SYNOPSIS\n.B rebake\n.I command\n[options]\n"
      ".SH DESCRIPTION\nRebake loads scenes that were baked by MobileNeRF: triangle meshes whose textures hold neural "
      "features, and a small network that turns features and view direction into colour. It composes, edits, renders "
      "and exports them.\n.SH COMMANDS\n",
      troff(version));
  for (const SubcommandHelp& subcommand : subcommands) {
    out += fmt::format(".SS rebake {}\n{}\n", troff(subcommand.name), troff(subcommand.help));
    for (const OptionHelp& option : subcommand.options) {
      std::vector<std::string> bold;
      for (const std::string& flag : flags_of(option)) bold.push_back("\\fB" + troff(flag) + "\\fR");
      const std::string value = option.hint.empty() ? "" : "\\fI" + troff(option.hint) + "\\fR";
      const std::string head = is_positional(option) ? (value.empty() ? "\\fI" + troff(option.names) + "\\fR" : value)
                                                     : joined(bold, ", ") + (value.empty() ? "" : " " + value);
      // Most placeholders list the words already.
      const bool lists_words = option.words.empty() || option.hint.find(joined(option.words, "|")) != std::string::npos;
      const std::string words = lists_words ? "" : "; one of: " + joined(option.words, ", ");
      out += fmt::format(".TP\n{}\n{}\n", head, troff(option.help + words));
    }
    if (!subcommand.footer.empty()) out += ".PP\n" + troff(subcommand.footer) + "\n";
  }
  return out + ".SH EXIT STATUS\n" + troff(exit_code_help) + "\n";
}

std::string bash_completion(const std::vector<SubcommandHelp>& subcommands) {
  std::string words, options;
  for (const SubcommandHelp& subcommand : subcommands) {
    options +=
        fmt::format("    {}) options={} ;;\n", subcommand.name, single_quoted(joined(all_flags(subcommand), " ")));
    for (const OptionHelp& option : subcommand.options) {
      if (option.words.empty()) continue;
      std::vector<std::string> cases;
      for (const std::string& flag : flags_of(option)) cases.push_back(subcommand.name + ":" + flag);
      // The words of a positional argument are offered for the first one.
      if (is_positional(option)) cases.push_back(subcommand.name + ":" + subcommand.name);
      words += fmt::format("    {}) words={} ;;\n", joined(cases, "|"), single_quoted(joined(option.words, " ")));
    }
  }
  return fmt::format(
      "_rebake() {{\n"
      "  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} options= words=\n"
      "  COMPREPLY=()\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
      "    COMPREPLY=($(compgen -W '{} --help --version' -- \"$current\"))\n"
      "    return\n"
      "  fi\n"
      "  case ${{COMP_WORDS[1]}} in\n{}  esac\n"
      "  case ${{COMP_WORDS[1]}}:$previous in\n{}  esac\n"
      "  if [[ $current == -* ]]; then\n"
      "    COMPREPLY=($(compgen -W \"$options\" -- \"$current\"))\n"
      "  elif [ -n \"$words\" ]; then\n"
      "    COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
      "  fi\n"
      "}}\n"
      "complete -o default -F _rebake rebake\n",
      joined(names_of(subcommands), " "), options, words);
}

std::string zsh_completion(const std::vector<SubcommandHelp>& subcommands) {
  std::string names, cases;
  for (const SubcommandHelp& subcommand : subcommands) {
    names += fmt::format("    {}\n", single_quoted(zsh_text(subcommand.name) + ":" + subcommand.help));
    cases += fmt::format("  {}) _arguments \\\n", subcommand.name);
    for (const OptionHelp& option : subcommand.options) {
      if (is_positional(option)) continue;
      for (const std::string& flag : flags_of(option))
        cases += fmt::format("    {} \\\n", single_quoted(flag + "[" + zsh_text(option.help) + "]" +
                                                          (option.hint.empty() ? "" : ":" + zsh_value(option))));
    }
    const auto positional = std::find_if(subcommand.options.begin(), subcommand.options.end(), is_positional);
    const bool has_words = positional != subcommand.options.end() && !positional->words.empty();
    if (has_words) cases += fmt::format("    {} \\\n", single_quoted("1:" + zsh_value(*positional)));
    cases += "    '--help[print help]' '*:file:_files' ;;\n";
  }
  return fmt::format(
      "#compdef rebake\n"
      "local -a commands\n"
      "commands=(\n{})\n"
      "if (( CURRENT == 2 )); then\n"
      "  _describe command commands\n"
      "  return\n"
      "fi\n"
      "shift words\n"
      "(( CURRENT-- ))\n"
      "case ${{words[1]}} in\n{}esac\n",
      names, cases);
}

std::string fish_completion(const std::vector<SubcommandHelp>& subcommands) {
  std::string out = "complete -c rebake -n __fish_use_subcommand -l version -d 'print the version'\n";
  for (const SubcommandHelp& subcommand : subcommands) {
    out += fmt::format("complete -c rebake -n __fish_use_subcommand -f -a {} -d {}\n", subcommand.name,
                       single_quoted(subcommand.help));
    const std::string when = fmt::format("complete -c rebake -n '__fish_seen_subcommand_from {}'", subcommand.name);
    for (const OptionHelp& option : subcommand.options) {
      const std::string words = option.words.empty() ? "" : " -f -a " + single_quoted(joined(option.words, " "));
      std::string flags;
      for (const std::string& flag : flags_of(option))
        flags += flag.starts_with("--") ? " -l " + flag.substr(2) : " -s " + flag.substr(1);
      if (flags.empty() && words.empty()) continue;
      out += fmt::format("{}{}{}{} -d {}\n", when, flags, option.hint.empty() || flags.empty() ? "" : " -r", words,
                         single_quoted(option.help));
    }
  }
  return out;
}

}  // namespace rebake
