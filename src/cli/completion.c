#include "cli/completion.h"

#include "cli/describe.h"
#include "cli/options.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* One command with all that a shell is told of it. */
typedef struct Completed {
    const DescribedCommand *command;
    DescribedOption options[DESCRIBED_OPTIONS];
    size_t count;
} Completed;

static Completed complete(const DescribedCommand *command)
{
    Completed completed = {.command = command};
    completed.count = describe_options(command, completed.options);
    return completed;
}

static const char *text_of(const Text *text)
{
    return text->bytes ? text->bytes : "";
}

/* "a b " as "a|b", for a pattern. */
static void put_pattern(const char *words)
{
    for (const char *c = words; *c; c++)
        if (*c != ' ')
            putchar(*c);
        else if (c[1])
            putchar('|');
}

/* The first clause of a description, for a line in a menu, between single quotes: quote is how one
 * stands there. What zsh reads in a description is left out. */
static void put_summary(const char *doc, const char *quote)
{
    size_t length = 0, most = 60;
    for (size_t i = 1; i <= most && doc[i - 1]; i++)
        if (strchr(" ;.(", doc[i]) || doc[i] == '\0')
            length = i;
    for (size_t i = 0; i < length; i++) {
        if (doc[i] == ';' || (doc[i] == '.' && doc[i + 1] == ' '))
            break;
        if (doc[i] == '\'')
            fputs(quote, stdout);
        else
            putchar(strchr("\"[]:\\$`", doc[i]) ? ' ' : doc[i]);
    }
}

static const char quote_zsh[] = "'\\''", quote_fish[] = "\\'";

/* Top-level commands and blend's have one word each here. */
static const char *last_word(const char *name)
{
    const char *space = strrchr(name, ' ');
    return space ? space + 1 : name;
}

/* ---- bash ----------------------------------------------------------------------------------- */

static const char bash_head[] =
    "# bash completion of peel; made by 'peel --completion bash'.\n"
    "_peel_words() {\n"
    "    local word\n"
    "    while IFS= read -r word; do\n"
    "        COMPREPLY+=(\"$word\")\n"
    "    done < <(compgen -W \"$1\" -- \"$cur\")\n"
    "}\n\n"
    "# Folders, and files whose names end in one of the words; all files without any.\n"
    "_peel_files() {\n"
    "    local file ending\n"
    "    compopt -o filenames 2>/dev/null\n"
    "    while IFS= read -r file; do\n"
    "        if [ -d \"$file\" ] || [ $# = 0 ]; then\n"
    "            COMPREPLY+=(\"$file\")\n"
    "            continue\n"
    "        fi\n"
    "        for ending in \"$@\"; do\n"
    "            case $file in *.\"$ending\") COMPREPLY+=(\"$file\") ;; esac\n"
    "        done\n"
    "    done < <(compgen -f -- \"$cur\")\n"
    "}\n\n"
    "_peel() {\n"
    "    local cur=${COMP_WORDS[COMP_CWORD]} prev= command=${COMP_WORDS[1]}\n"
    "    COMPREPLY=()\n"
    "    [ \"$COMP_CWORD\" -gt 1 ] && prev=${COMP_WORDS[COMP_CWORD - 1]}\n"
    "    # --option=value is three words.\n"
    "    if [ \"$cur\" = = ]; then\n"
    "        cur=\n"
    "    elif [ \"$prev\" = = ] && [ \"$COMP_CWORD\" -gt 2 ]; then\n"
    "        prev=${COMP_WORDS[COMP_CWORD - 2]}\n"
    "    fi\n";

static void bash_value(DescribedKind kind, const char *words, const char *endings)
{
    if (kind == DESCRIBED_VALUES)
        printf("_peel_words '%s'", words);
    if (kind == DESCRIBED_VALUES && *endings)
        printf("; ");
    if (kind == DESCRIBED_FOLDER)
        printf("compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -d -- "
               "\"$cur\")");
    if (kind == DESCRIBED_FILE || *endings)
        printf("_peel_files %s", endings);
    if (kind == DESCRIBED_FREE)
        printf(":");
}

static void bash_option(const DescribedOption *described)
{
    const struct argp_option *option = described->option;
    Text words = {0};
    DescribedKind kind = describe_value(option, &words);
    bool files = kind == DESCRIBED_FILE;
    if (kind != DESCRIBED_NOTHING && !(option->flags & OPTION_ARG_OPTIONAL)) {
        printf("        --%s", option->name);
        if (describe_letter(option))
            printf(" | -%c", describe_letter(option));
        printf(")\n            ");
        if (kind == DESCRIBED_SCENE)
            bash_value(DESCRIBED_VALUES, text_of(&words), "gltf glb");
        else
            bash_value(kind, files ? "" : text_of(&words), files ? text_of(&words) : "");
        printf("\n            return\n            ;;\n");
    }
    text_free(&words);
}

static void bash_command(const Completed *completed)
{
    const DescribedCommand *command = completed->command;
    Text words = {0}, endings = {0};
    printf("    '%s')\n        case $prev in\n", command->name);
    for (size_t i = 0; i < completed->count; i++)
        bash_option(&completed->options[i]);
    printf("        esac\n        case $cur in\n        -*) _peel_words '");
    for (size_t i = 0; i < completed->count; i++) {
        const struct argp_option *option = completed->options[i].option;
        printf("--%s ", option->name);
        if (describe_letter(option))
            printf("-%c ", describe_letter(option));
    }
    printf("--help' ;;\n        *) ");
    DescribedKind kind = describe_arguments(command, &words, &endings);
    bash_value(kind, text_of(&words), text_of(&endings));
    printf(" ;;\n        esac\n        ;;\n");
    text_free(&words);
    text_free(&endings);
}

/* The words that may follow parent: of "" the commands, of "blend" its own. */
static void put_commands(const DescribedCommand *commands, size_t count, const char *parent)
{
    size_t length = strlen(parent);
    for (size_t i = 0; i < count; i++) {
        bool below = length && strncmp(commands[i].name, parent, length) == 0 &&
                     commands[i].name[length] == ' ';
        if (length ? below : !strchr(commands[i].name, ' '))
            printf("%s ", last_word(commands[i].name));
    }
}

static void print_bash(const DescribedCommand *commands, size_t count)
{
    fputs(bash_head, stdout);
    printf("    if [ \"$COMP_CWORD\" = 1 ]; then\n        _peel_words '");
    put_commands(commands, count, "");
    printf("--help --version --man --completion'\n        return\n    fi\n"
           "    case $command in\n    --version) _peel_words --json; return ;;\n"
           "    --completion) _peel_words 'bash zsh fish'; return ;;\n    --man) _peel_words '");
    put_commands(commands, count, "");
    printf("'; return ;;\n");
    for (size_t i = 0; i < count; i++)
        if (commands[i].form_count == 0) {
            printf("    %s)\n        if [ \"$COMP_CWORD\" = 2 ]; then\n            _peel_words '",
                   commands[i].name);
            put_commands(commands, count, commands[i].name);
            printf("--help'\n            return\n        fi\n"
                   "        command=\"$command ${COMP_WORDS[2]}\"\n        ;;\n");
        }
    printf("    esac\n    case $command in\n");
    for (size_t i = 0; i < count; i++)
        if (commands[i].form_count > 0) {
            Completed completed = complete(&commands[i]);
            bash_command(&completed);
        }
    printf("    esac\n}\ncomplete -F _peel peel\n");
}

/* ---- zsh ------------------------------------------------------------------------------------ */

/* message:action of _arguments. */
static void zsh_value(DescribedKind kind, const char *message, const char *words,
                      const char *endings)
{
    printf(":%s:", message);
    if (kind == DESCRIBED_VALUES && *endings) {
        printf("{compadd -- %s; _files -g \"*.(", words);
        put_pattern(endings);
        printf(")\"}");
    } else if (kind == DESCRIBED_VALUES)
        printf("(%s)", words);
    else if (kind == DESCRIBED_FOLDER)
        printf("_files -/");
    else if (kind == DESCRIBED_FILE && *endings) {
        printf("_files -g \"*.(");
        put_pattern(endings);
        printf(")\"");
    } else if (kind == DESCRIBED_FILE)
        printf("_files");
    else
        printf(" ");
}

static void zsh_option(const DescribedOption *described)
{
    const struct argp_option *option = described->option;
    Text words = {0};
    DescribedKind kind = describe_value(option, &words);
    bool files = kind == DESCRIBED_FILE, optional = option->flags & OPTION_ARG_OPTIONAL;
    for (int letter = 0; letter < 1 + (describe_letter(option) != 0); letter++) {
        if (letter)
            printf(" \\\n            '*-%c[", describe_letter(option));
        else
            printf(" \\\n            '*--%s%s[", option->name,
                   kind == DESCRIBED_NOTHING ? ""
                   : optional                ? "=-"
                                             : "=");
        put_summary(option->doc, quote_zsh);
        printf("]");
        if (optional)
            printf(":");
        if (kind == DESCRIBED_SCENE)
            zsh_value(DESCRIBED_VALUES, "scene", text_of(&words), "gltf glb ");
        else if (kind != DESCRIBED_NOTHING)
            zsh_value(kind, option->name, files ? "" : text_of(&words),
                      files ? text_of(&words) : "");
        printf("'");
    }
    text_free(&words);
}

static void zsh_command(const Completed *completed)
{
    const DescribedCommand *command = completed->command;
    Text words = {0}, endings = {0};
    DescribedKind kind = describe_arguments(command, &words, &endings);
    printf("    '%s')\n        _arguments", command->name);
    for (size_t i = 0; i < completed->count; i++)
        zsh_option(&completed->options[i]);
    printf(" \\\n            '--help[This list]'");
    if (kind != DESCRIBED_FREE) {
        printf(" \\\n            '*");
        zsh_value(kind, "argument", text_of(&words), text_of(&endings));
        printf("'");
    }
    printf("\n        ;;\n");
    text_free(&words);
    text_free(&endings);
}

static void zsh_commands(const DescribedCommand *commands, size_t count, const char *parent)
{
    size_t length = strlen(parent);
    for (size_t i = 0; i < count; i++) {
        bool below = length && strncmp(commands[i].name, parent, length) == 0 &&
                     commands[i].name[length] == ' ';
        if (!(length ? below : !strchr(commands[i].name, ' ')))
            continue;
        printf(" '%s:", last_word(commands[i].name));
        put_summary(commands[i].summary, quote_zsh);
        printf("'");
    }
}

static void print_zsh(const DescribedCommand *commands, size_t count)
{
    printf("#compdef peel\n# zsh completion of peel; made by 'peel --completion zsh'.\n"
           "_peel() {\n    local command=$words[2]\n    local -a names\n"
           "    if (( CURRENT == 2 )); then\n        names=(");
    zsh_commands(commands, count, "");
    printf(")\n        _describe command names\n"
           "        compadd -- --help --version --man --completion\n        return\n    fi\n"
           "    case $command in\n");
    for (size_t i = 0; i < count; i++)
        if (commands[i].form_count == 0) {
            printf("    %s)\n        if (( CURRENT == 3 )); then\n            names=(",
                   commands[i].name);
            zsh_commands(commands, count, commands[i].name);
            printf(")\n            _describe command names\n            return\n        fi\n"
                   "        command=\"$command $words[3]\"\n        shift words\n"
                   "        (( CURRENT-- ))\n        ;;\n");
        }
    printf("    esac\n    shift words\n    (( CURRENT-- ))\n    case $command in\n"
           "    --completion) compadd bash zsh fish ;;\n    --version) compadd -- --json ;;\n");
    for (size_t i = 0; i < count; i++)
        if (commands[i].form_count > 0) {
            Completed completed = complete(&commands[i]);
            zsh_command(&completed);
        }
    printf("    esac\n}\n_peel \"$@\"\n");
}

/* ---- fish ----------------------------------------------------------------------------------- */

static const char fish_head[] =
    "# fish completion of peel; made by 'peel --completion fish'.\n"
    "# The command so far, as 'render' or 'blend check'.\n"
    "function __peel_command\n"
    "    set -l words (commandline -opc)\n"
    "    if test (count $words) -lt 2\n"
    "        echo ''\n"
    "    else if test $words[2] = blend; and test (count $words) -gt 2\n"
    "        echo $words[2] $words[3]\n"
    "    else\n"
    "        echo $words[2]\n"
    "    end\n"
    "end\n"
    "function __peel_is\n"
    "    test (__peel_command) = \"$argv\"\n"
    "end\n"
    "function __peel_files\n"
    "    for ending in $argv\n"
    "        __fish_complete_suffix .$ending\n"
    "    end\n"
    "end\n"
    "complete -c peel -f\n";

static void fish_value(DescribedKind kind, const char *words, const char *endings)
{
    if (kind == DESCRIBED_VALUES && *endings)
        printf(" -a '%s(__peel_files %s)'", words, endings);
    else if (kind == DESCRIBED_VALUES)
        printf(" -a '%s'", words);
    else if (kind == DESCRIBED_FOLDER)
        printf(" -a '(__fish_complete_directories)'");
    else if (kind == DESCRIBED_FILE && *endings)
        printf(" -a '(__peel_files %s)'", endings);
    else if (kind == DESCRIBED_FILE)
        printf(" -F");
}

static void fish_command(const Completed *completed)
{
    const char *name = completed->command->name;
    Text arguments = {0}, endings = {0};
    for (size_t i = 0; i < completed->count; i++) {
        const struct argp_option *option = completed->options[i].option;
        Text words = {0};
        DescribedKind kind = describe_value(option, &words);
        bool files = kind == DESCRIBED_FILE;
        printf("complete -c peel -n '__peel_is %s' -l %s", name, option->name);
        if (describe_letter(option))
            printf(" -s %c", describe_letter(option));
        printf(" -d '");
        put_summary(option->doc, quote_fish);
        printf("'");
        if (kind != DESCRIBED_NOTHING && !(option->flags & OPTION_ARG_OPTIONAL))
            printf(files && !words.count ? " -r" : " -x");
        if (kind == DESCRIBED_SCENE)
            fish_value(DESCRIBED_VALUES, text_of(&words), "gltf glb ");
        else
            fish_value(kind, files ? "" : text_of(&words), files ? text_of(&words) : "");
        printf("\n");
        text_free(&words);
    }
    DescribedKind kind = describe_arguments(completed->command, &arguments, &endings);
    if (kind != DESCRIBED_FREE) {
        printf("complete -c peel -n '__peel_is %s'", name);
        fish_value(kind, text_of(&arguments), text_of(&endings));
        printf("\n");
    }
    text_free(&arguments);
    text_free(&endings);
}

static void print_fish(const DescribedCommand *commands, size_t count)
{
    fputs(fish_head, stdout);
    for (size_t i = 0; i < count; i++) {
        const char *space = strchr(commands[i].name, ' ');
        printf("complete -c peel -n 'test (__peel_command) = \"%.*s\"' -a %s -d '",
               space ? (int)(space - commands[i].name) : 0, commands[i].name,
               last_word(commands[i].name));
        put_summary(commands[i].summary, quote_fish);
        printf("'\n");
    }
    printf("complete -c peel -n 'test (__peel_command) = \"\"' -l help -l version -l man -l "
           "completion\n");
    for (size_t i = 0; i < count; i++)
        if (commands[i].form_count > 0) {
            Completed completed = complete(&commands[i]);
            fish_command(&completed);
        }
}

int completion_print(int argc, char **argv)
{
    DescribedCommand commands[DESCRIBED_COMMANDS];
    size_t count = describe_commands(commands);
    const char *shell = argc == 1 ? argv[0] : "";
    if (strcmp(shell, "bash") == 0)
        print_bash(commands, count);
    else if (strcmp(shell, "zsh") == 0)
        print_zsh(commands, count);
    else if (strcmp(shell, "fish") == 0)
        print_fish(commands, count);
    else
        return options_fail(result_fail(RESULT_BAD_INPUT,
                                        "--completion%s%s: expected one of bash, zsh and fish",
                                        argc > 0 ? " " : "", argc > 0 ? argv[argc - 1] : ""));
    return EXIT_AGREE;
}
