"""The documents of the analyses: a domain with arguments in, a result with what it was found from out.

As in `service.schemas` the models describe shapes; faults are found and told by the library, in the worker.
"""
