#include "report/diagnose.h"
Result report_diagnose_html(const DiagnoseSubject *subject, const Diagnosis *diagnosis,
                            const char *dir)
{
    (void)subject;
    (void)diagnosis;
    (void)dir;
    return RESULT_OK;
}
