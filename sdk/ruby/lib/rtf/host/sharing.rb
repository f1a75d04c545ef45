# frozen_string_literal: true

module RTF
  module Host
    # What tells one test from the next in a host that several share: see "Shared
    # hosts" in spec/protocol.md.
    class Sharing
      # `prctl`'s number for: orphans below this process become its children.
      SET_CHILD_SUBREAPER = 36
      private_constant :SET_CHILD_SUBREAPER

      # Prepares for several tests; nil when this interpreter cannot have them.
      #
      # What a test's process leaves must come here and not to the runner, so that
      # it is known whose it is.
      def self.begin
        require "fiddle" # not every interpreter has it
        number = Fiddle::TYPE_LONG
        prctl = Fiddle::Function.new(Fiddle::Handle::DEFAULT["prctl"],
                                     [Fiddle::TYPE_INT, *([number] * 4)], Fiddle::TYPE_INT)
        return unless prctl.call(SET_CHILD_SUBREAPER, 1, 0, 0, 0).zero?

        new([1, 2].map { |descriptor| IO.for_fd(descriptor, autoclose: false).dup })
      rescue LoadError, SystemCallError, Fiddle::DLError
        nil
      end

      # Keeps the outputs as the runner gave them, whatever a plug-in makes of its own.
      def initialize(outputs)
        @outputs = outputs.each do |output|
          output.binmode
          output.sync = true
        end
      end

      # Ends what the test has printed, if the next one may begin.
      def stay(mark)
        return false if children?

        @outputs.each { |output| output.write(mark) }
        true
      rescue SystemCallError
        false
      end

      private

      # Whether there are processes that the test left; those that have ended are taken in.
      def children?
        nil while Process.wait(-1, Process::WNOHANG)
        true
      rescue Errno::ECHILD
        false
      end
    end
  end
end
