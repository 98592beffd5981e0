#include "cli/manual.h"

#include "cli/describe.h"
#include "cli/options.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Hand-written sections. "@ render" begins what stands in the page of `peel render`, "@" alone what
 * stands in all. */
extern const char cli_manual_roff[];

/* ---- roff ----------------------------------------------------------------------------------- */

/* Words as they are: no hyphen becomes a dash, no line a request. */
static void put_escaped(const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++)
        if (text[i] == '-')
            fputs("\\-", stdout);
        else if (text[i] == '\\')
            fputs("\\e", stdout);
        else
            putchar(text[i]);
}

static void put_line(const char *text, size_t length)
{
    if (length && (*text == '.' || *text == '\''))
        fputs("\\&", stdout);
    put_escaped(text, length);
    putchar('\n');
}

/* Paragraphs and, indented, lines that stay as they are. */
static void put_text(const char *text, size_t length)
{
    bool verbatim = false, first = true;
    for (const char *line = text; line < text + length;) {
        size_t count = 0;
        while (line + count < text + length && line[count] != '\n')
            count++;
        bool indented = count > 1 && line[0] == ' ' && line[1] == ' ';
        if (indented != verbatim && count > 0) {
            printf(indented ? ".PP\n.nf\n" : ".fi\n.PP\n");
            verbatim = indented;
        } else if (count > 0 && !verbatim && !first)
            printf(".br\n");
        if (count > 0)
            put_line(line, count);
        else if (!verbatim && !first)
            printf(".PP\n");
        first = count == 0;
        line += count + 1;
    }
    if (verbatim)
        printf(".fi\n");
}

/* Dashes for the spaces of "peel blend check", as a page is called. */
static void put_page_name(const char *name)
{
    fputs("peel", stdout);
    if (*name)
        fputs("\\-", stdout);
    for (const char *c = name; *c; c++)
        fputs(*c == ' ' ? "\\-" : (char[]){*c, '\0'}, stdout);
}

/* ---- sections ------------------------------------------------------------------------------- */

/* The part of manual.roff that "@ name" begins, up to the next; *length 0: there is none. */
static const char *find_part(const char *name, size_t *length)
{
    size_t wanted = strlen(name);
    *length = 0;
    for (const char *at = cli_manual_roff; (at = strchr(at, '@')); at++) {
        const char *title = at + 1 + (at[1] == ' ');
        if ((at > cli_manual_roff && at[-1] != '\n') || strcspn(title, "\n") != wanted ||
            strncmp(title, name, wanted) != 0)
            continue;
        const char *text = title + wanted + 1, *end = strstr(text, "\n@");
        *length = end ? (size_t)(end + 1 - text) : strlen(text);
        return text;
    }
    return "";
}

static void put_part(const char *name)
{
    size_t length;
    const char *text = find_part(name, &length);
    printf("%.*s", (int)length, text);
}

static void put_head(const char *name, const char *summary)
{
    printf(".TH ");
    for (const char *c = "PEEL"; *c; c++)
        putchar(*c);
    if (*name)
        printf("\\-");
    for (const char *c = name; *c; c++)
        *c == ' ' ? (void)printf("\\-") : (void)putchar(toupper((unsigned char)*c));
    printf(" 1 \"\" \"Peel %s\" \"User Commands\"\n.SH NAME\n", PEEL_VERSION);
    put_page_name(name);
    printf(" \\- ");
    put_line(summary, strlen(summary));
}

static void put_synopsis(const DescribedCommand *command)
{
    printf(".SH SYNOPSIS\n");
    for (size_t i = 0; i < command->form_count; i++) {
        const char *rest = command->forms[i]->args_doc;
        do { /* a line each */
            size_t length = strcspn(rest, "\n");
            printf("%s.B peel %s\n[\\fIOPTION\\fR...] ",
                   i || rest > command->forms[i]->args_doc ? ".br\n" : "", command->name);
            put_line(rest, length);
            rest += length + (rest[length] == '\n');
        } while (*rest);
    }
}

static void put_description(const DescribedCommand *command)
{
    printf(".SH DESCRIPTION\n");
    for (size_t i = 0; i < command->form_count; i++) {
        const char *doc = command->forms[i]->doc;
        size_t length = strcspn(doc, "\v");
        printf("%s", i ? ".PP\n" : "");
        put_text(doc, length);
        if (doc[length]) {
            printf(".PP\n");
            put_text(doc + length + 1, strlen(doc + length + 1));
        }
    }
}

static void put_option(const struct argp_option *option)
{
    bool optional = option->flags & OPTION_ARG_OPTIONAL;
    char letter = describe_letter(option);
    printf(".TP\n");
    if (letter && option->arg)
        printf("\\fB\\-%c\\fR \\fI%s\\fR, ", letter, option->arg);
    else if (letter)
        printf("\\fB\\-%c\\fR, ", letter);
    printf("\\fB\\-\\-");
    put_escaped(option->name, strlen(option->name));
    printf("\\fR");
    if (option->arg) {
        printf("%s=\\fI", optional ? "[" : "");
        put_escaped(option->arg, strlen(option->arg));
        printf("\\fR%s", optional ? "]" : "");
    }
    printf("\n");
    put_line(option->doc, strlen(option->doc));
}

static void put_options(const DescribedCommand *command)
{
    DescribedOption options[DESCRIBED_OPTIONS];
    size_t count = describe_options(command, options);
    const char *group = NULL;
    printf(".SH OPTIONS\n");
    if (command->dash)
        printf("A single dash may begin long options, too.\n");
    for (size_t i = 0; i < count; i++) {
        if (options[i].group && options[i].group != group) {
            printf(".SS ");
            put_line(options[i].group, strcspn(options[i].group, ":"));
        }
        group = options[i].group;
        put_option(options[i].option);
    }
    printf(".SS Help\n.TP\n\\fB\\-\\-help\\fR\nPrint the options, and end.\n");
}

/* ---- pages ---------------------------------------------------------------------------------- */

/* Commands below name, with their lines; of "" the whole list. */
static void put_commands(const DescribedCommand *commands, size_t count, const char *name)
{
    size_t length = strlen(name);
    printf(".SH COMMANDS\n");
    for (size_t i = 0; i < count; i++) {
        if (length &&
            (strncmp(commands[i].name, name, length) != 0 || commands[i].name[length] != ' '))
            continue;
        printf(".TP\n.BR ");
        put_page_name(commands[i].name);
        printf(" (1)\n");
        put_line(commands[i].summary, strlen(commands[i].summary));
    }
}

static void put_see_also(const DescribedCommand *commands, size_t count, const char *name)
{
    const char *separator = "";
    printf(".SH SEE ALSO\n");
    for (size_t i = 0; i <= count; i++) {
        const char *other = i ? commands[i - 1].name : "";
        if (strcmp(other, name) == 0)
            continue;
        printf("%s.BR ", separator);
        put_page_name(other);
        printf(" (1)");
        separator = ",\n";
    }
    printf("\n");
}

static void put_page(const DescribedCommand *commands, size_t count,
                     const DescribedCommand *command)
{
    const char *name = command ? command->name : "";
    put_head(name, command ? command->summary : "the reference for order-independent transparency");
    if (command && command->form_count > 0) {
        put_synopsis(command);
        put_description(command);
        put_options(command);
        put_part(name);
    } else {
        put_part(command ? name : "peel");
        put_commands(commands, count, name);
    }
    put_part("");
    put_see_also(commands, count, name);
}

static int put_list(const DescribedCommand *commands, size_t count)
{
    puts("peel");
    for (size_t i = 0; i < count; i++) {
        printf("peel-");
        for (const char *c = commands[i].name; *c; c++)
            putchar(*c == ' ' ? '-' : *c);
        putchar('\n');
    }
    return EXIT_AGREE;
}

/* Whether words, with spaces or dashes between, are the command's name or its page's. */
static bool is_name(const char *name, int argc, char **argv)
{
    char text[64] = "";
    for (int i = 0; i < argc; i++) {
        size_t length = strlen(text);
        snprintf(text + length, sizeof text - length, "%s%s", i ? " " : "", argv[i]);
    }
    const char *asked = strncmp(text, "peel-", 5) == 0 ? text + 5 : text;
    size_t i = 0;
    while (name[i] && (asked[i] == name[i] || (name[i] == ' ' && asked[i] == '-')))
        i++;
    return name[i] == '\0' && asked[i] == '\0';
}

int manual_print(int argc, char **argv)
{
    DescribedCommand commands[DESCRIBED_COMMANDS];
    size_t count = describe_commands(commands);
    if (argc == 1 && strcmp(argv[0], "--list") == 0)
        return put_list(commands, count);
    if (argc == 0 || (argc == 1 && strcmp(argv[0], "peel") == 0)) {
        put_page(commands, count, NULL);
        return EXIT_AGREE;
    }
    for (size_t i = 0; i < count; i++)
        if (is_name(commands[i].name, argc, argv)) {
            put_page(commands, count, &commands[i]);
            return EXIT_AGREE;
        }
    return options_fail(result_fail(
        RESULT_BAD_INPUT, "--man %s: no such command; see 'peel --help'", argv[argc - 1]));
}
