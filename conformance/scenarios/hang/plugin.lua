function TestCase.run()
  rtf.report("going to hang")
  -- One call of a C function that tries more ways to match than there is time
  -- for: no instruction of Lua is carried out any more.
  string.find(("x"):rep(100), (".-"):rep(50) .. "y")
end
