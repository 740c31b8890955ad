"""The learned reader of reports that number their vehicles: questions, answers, and how sure these are."""
