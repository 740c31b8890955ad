"""`sgcad desk`: cases of a results folder in a browser, to see which to trust and to correct the others.

`rows` is what the list shows of a case, `index` keeps all rows of a folder in memory, `choosing` filters and sorts
them; `case` and `roadmap` are what a case's page shows; `mending` lays a person's edits over a case in a process of
its own; `guard` refuses foreign requests; `pages` and `app` serve them, `command` is the command line.
"""
