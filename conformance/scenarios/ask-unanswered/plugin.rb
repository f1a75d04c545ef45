require "rtf"

class AskUnanswered < RTF::TestCase
  def run
    ask("Is the hand closed?", %w[yes no])
    report("not reached")
  end

  def tear_down
    report("torn down")
  end
end
