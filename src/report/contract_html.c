/* The page about the contract for producers; its text is contract.html. */
#include "base/file.h"
#include "report/contract.h"

#include <string.h>

extern const char report_style_css[], report_contract_body[];

Result report_contract_page(const char *path)
{
    FileWriter page;
    Result result = file_writer_open(path, &page);
    if (result != RESULT_OK)
        return result;
    file_writer_print(&page, "<!doctype html>\n<html lang=\"en\">\n<head>\n"
                             "<meta charset=\"utf-8\">\n"
                             "<meta name=\"viewport\" content=\"width=device-width, "
                             "initial-scale=1\">\n<title>A comparable image</title>\n<style>\n");
    file_writer_put(&page, report_style_css, strlen(report_style_css));
    file_writer_print(&page, "</style>\n</head>\n<body>\n");
    file_writer_put(&page, report_contract_body, strlen(report_contract_body));
    file_writer_print(&page, "</body>\n</html>\n");
    return file_writer_close(&page, true);
}
