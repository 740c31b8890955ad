"""`sgcad desk`: cases of a results folder in a browser, to see which to trust, mend the others, and go on.

`rows` is what the list shows of a case, `index` keeps all rows of a folder in memory, `choosing` filters and sorts
them; `case` and `roadmap` are what a case's page shows; `mending` lays a person's edits over a case in a process of
its own; `guard` keeps strangers out; `pages` and `app` put them on the web, `command` on the command line.
"""
