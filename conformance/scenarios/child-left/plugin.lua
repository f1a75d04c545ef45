function TestCase.run()
  os.execute("setsid bash -c 'exec -a rtf-left-behind sleep 1000' &")
  rtf.report("child started")
end
