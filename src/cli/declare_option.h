#pragma once
// Flags of a command that write into a struct of options.

#include <CLI/CLI.hpp>

#include "gl/flag_names.h"

namespace phat {

/// Declares the flags of one command. `type`: what the help calls the value.
struct DeclareOption {
    CLI::App& command;

    /// Read after parsing, by CLI::App::get_option.
    CLI::Option* text(const char* name, const char* type, const std::string& help) const {
        return command.add_option(name, help)->type_name(type);
    }
    template <typename Value>
    CLI::Option* value(const char* name, const char* type, Value& value, const std::string& help) const {
        return command.add_option(name, value, help)->type_name(type);
    }
    CLI::Option* flag(const char* name, bool& value, const std::string& help) const {
        return command.add_flag(name, value, help);
    }
    /// One of a table's names. `names` must outlive the command.
    template <typename Names, typename Value>
    CLI::Option* choice(const char* name, const Names& names, Value& value, const std::string& help) const {
        return command
            .add_option_function<std::string>(
                name, [&names, &value](const std::string& chosen) { value = valueOf(names, chosen); }, help)
            ->type_name("NAME")
            ->check(CLI::IsMember(namesOf(names)))
            ->default_str(nameOf(names, value));
    }
};

}  // namespace phat
