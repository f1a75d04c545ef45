function TestCase.run()
  local path = os.tmpname()
  local trace = assert(io.open(path, "w"))
  trace:write("t,q\n0,1\n")
  trace:close()
  rtf.attach(path, "trace.csv", "text/csv")
  os.remove(path)
end
