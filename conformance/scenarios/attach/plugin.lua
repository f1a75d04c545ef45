function TestCase.run()
  local path = io.popen("mktemp -d"):read("l") .. "/trace.csv"
  local trace = assert(io.open(path, "w"))
  trace:write("t,q\n0,1\n")
  trace:close()
  rtf.attach(path, "trace.csv", "text/csv")
end
