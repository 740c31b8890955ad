"""How each vehicle moved before the crash: clauses, maneuvers, headings, signals."""
