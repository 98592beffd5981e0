#include "cli/describe.h"

#include "cli/bind.h"
#include "cli/options.h"
#include "frame/method.h"
#include "frame/mutation.h"
#include "frame/setting.h"
#include "scene/generate.h"
#include "scene/hard_scenes.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* ---- commands ------------------------------------------------------------------------------- */

/* Words that lead to another form of a command. */
static const struct {
    const char *command;
    char *words[2];
} other_forms[] = {
    {"explain", {"--pixel", "0,0"}},
    {"explain", {"--course", NULL}},
};

static void take(void *context, const struct argp *argp, bool dash)
{
    DescribedCommand *command = context;
    if (command->form_count < DESCRIBED_FORMS)
        command->forms[command->form_count++] = argp;
    command->dash = dash;
}

static void ask(DescribedCommand *out, const Command *command, char *const words[2])
{
    char name[48];
    snprintf(name, sizeof name, "peel %s", out->name);
    char *argv[] = {name, words[0], words[1], NULL};
    options_describe(take, out);
    command->run(words[0] ? words[1] ? 3 : 2 : 1, argv);
    options_describe(NULL, NULL);
}

static void describe_command(const Command *command, const char *parent, DescribedCommand *out)
{
    *out = (DescribedCommand){.summary = command->summary};
    snprintf(out->name, sizeof out->name, "%s%s%s", parent, *parent ? " " : "", command->name);
    if (command->subcommands)
        return;
    ask(out, command, (char *const[2]){NULL, NULL});
    for (size_t i = 0; i < sizeof other_forms / sizeof *other_forms; i++)
        if (strcmp(other_forms[i].command, out->name) == 0)
            ask(out, command, other_forms[i].words);
}

size_t describe_commands(DescribedCommand out[DESCRIBED_COMMANDS])
{
    size_t count = 0;
    for (const Command *command = commands; command->name && count < DESCRIBED_COMMANDS;
         command++) {
        describe_command(command, "", &out[count++]);
        for (const Command *sub = command->subcommands;
             sub && sub->name && count < DESCRIBED_COMMANDS; sub++)
            describe_command(sub, command->name, &out[count++]);
    }
    return count;
}

/* ---- options -------------------------------------------------------------------------------- */

static bool is_there(const DescribedOption *options, size_t count, const char *name)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(options[i].option->name, name) == 0)
            return true;
    return false;
}

static size_t add_options(const struct argp *argp, DescribedOption *out, size_t count)
{
    const char *group = NULL;
    for (const struct argp_option *option = argp->options; option && (option->name || option->doc);
         option++) {
        if (!option->name)
            group = option->doc;
        else if (count < DESCRIBED_OPTIONS && !is_there(out, count, option->name))
            out[count++] = (DescribedOption){option, group};
    }
    for (const struct argp_child *child = argp->children; child && child->argp; child++)
        count = add_options(child->argp, out, count);
    return count;
}

size_t describe_options(const DescribedCommand *command, DescribedOption out[DESCRIBED_OPTIONS])
{
    size_t count = 0;
    for (size_t i = 0; i < command->form_count; i++)
        count = add_options(command->forms[i], out, count);
    return count;
}

char describe_letter(const struct argp_option *option)
{
    return (char)(option->key > ' ' && option->key < 0x7f ? option->key : 0);
}

/* ---- values --------------------------------------------------------------------------------- */

static void add_scenes(Text *words)
{
    size_t count;
    const BuiltinScene *table = generate_table(&count);
    for (size_t i = 0; i < count; i++)
        text_print(words, "%s ", table[i].name);
}

/* A setting's choices; false where the option is none. */
static bool add_setting(const char *name, Text *words)
{
    for (int id = 0; id < SETTING_COUNT; id++) {
        const SettingInfo *setting = setting_info((SettingId)id);
        if (strcmp(setting->name, name) != 0)
            continue;
        for (int i = 0; i < setting_choice_count((SettingId)id); i++)
            text_print(words, "%s ", setting->choices[i]);
        return true;
    }
    return false;
}

/* The words in small letters of "N|auto"; false where there are none. */
static bool add_alternatives(const char *argument, Text *words)
{
    bool any = false;
    for (const char *from = argument; *from; from += *from == '|') {
        size_t length = strcspn(from, "|");
        if (islower((unsigned char)*from)) {
            text_print(words, "%.*s ", (int)length, from);
            any = true;
        }
        from += length;
    }
    return any;
}

/* The kinds of files that a description speaks of. */
static DescribedKind add_files(const struct argp_option *option, Text *words)
{
    static const char *const kinds[][2] = {{"PNG", "png"},      {"EXR", "exr"},   {".gltf", "gltf"},
                                           {".glb", "glb"},     {"HTML", "html"}, {".csv", "csv"},
                                           {".jsonl", "jsonl"}, {".bin", "bin"}};
    if (strcmp(option->name, "json") == 0)
        text_print(words, "json ");
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (strstr(option->doc, kinds[i][0]))
            text_print(words, "%s ", kinds[i][1]);
    return DESCRIBED_FILE;
}

DescribedKind describe_value(const struct argp_option *option, Text *words)
{
    const char *argument = option->arg;
    if (!argument)
        return DESCRIBED_NOTHING;
    if (strcmp(option->name, "method") == 0) {
        for (int i = 0; i < METHOD_COUNT; i++)
            text_print(words, "%s ", method_info((MethodId)i)->name);
        text_print(words, "all ");
        return DESCRIBED_VALUES;
    }
    if (strcmp(option->name, "mutate") == 0) {
        for (int i = 0; i < MUTATION_COUNT; i++)
            text_print(words, "%s ", mutation_info((MutationId)i)->name);
        return DESCRIBED_VALUES;
    }
    if (strcmp(argument, "SCENE") == 0) {
        add_scenes(words);
        return DESCRIBED_SCENE;
    }
    if (strcmp(argument, "FILE") == 0)
        return add_files(option, words);
    if (strcmp(argument, "DIR") == 0)
        return DESCRIBED_FOLDER;
    return add_setting(option->name, words) || add_alternatives(argument, words) ? DESCRIBED_VALUES
                                                                                 : DESCRIBED_FREE;
}

static void add_cases(Text *words)
{
    size_t count;
    const HardScene *table = hard_scenes_table(&count);
    for (size_t i = 0; i < count; i++)
        text_print(words, "%s ", table[i].name);
}

DescribedKind describe_arguments(const DescribedCommand *command, Text *words, Text *endings)
{
    static const struct {
        const char *begin;
        DescribedKind kind;
        const char *endings;
    } known[] = {
        {"SCENE THEIRS", DESCRIBED_VALUES, "gltf glb png exr peel "},
        {"SCENE IMAGE", DESCRIBED_VALUES, "gltf glb png exr "},
        {"SCENE", DESCRIBED_VALUES, "gltf glb "},
        {"[NAME", DESCRIBED_VALUES, "gltf glb "},
        {"A B", DESCRIBED_FILE, "png exr "},
        {"FILE", DESCRIBED_FILE, "exr "},
        {"[FILE]", DESCRIBED_FILE, "csv jsonl bin "},
        {"[CASE", DESCRIBED_VALUES, ""},
    };
    const char *usage = command->form_count ? command->forms[0]->args_doc : "";
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        if (strncmp(usage, known[i].begin, strlen(known[i].begin)) != 0)
            continue;
        if (strncmp(usage, "[CASE", 5) == 0)
            add_cases(words);
        else if (known[i].kind == DESCRIBED_VALUES)
            add_scenes(words);
        text_print(endings, "%s", known[i].endings);
        return known[i].kind;
    }
    return DESCRIBED_FREE;
}
