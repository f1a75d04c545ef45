# frozen_string_literal: true

require "rtf"
require "rtf/host/predecessor"

module RTF
  module Host
    # Loads a plug-in: a file with one class that derives from a class of the SDK.
    module Load
      # The file is no plug-in.
      class NoPlugin < LoadError
      end

      @previous = nil

      module_function

      # Runs the file and creates an object of its one class.
      def load(file, base)
        file = File.expand_path(file) # as Ruby names it
        forget_previous(file)
        directory = File.dirname(file)
        $LOAD_PATH.unshift(directory) unless $LOAD_PATH.first == directory
        Predecessor.add_module
        Kernel.load(file)
        found = classes(file, base)
        return found.first.new if found.length == 1

        old = Predecessor.find(file) if base == TestCase && found.empty?
        return Predecessor.new(old.new) if old

        refuse(file, base, found)
      end

      def refuse(file, base, found)
        message =
          if found.empty?
            others = classes(file, Plugin).map { |one| "`#{one}`" }
            hint = others.empty? ? "" : "; it has #{others.join(", ")}"
            "`#{file}` has no class that derives from #{base}#{hint}"
          else
            names = found.map { |one| "`#{one}`" }.join(", ")
            "`#{file}` has several classes that derive from #{base}: #{names}"
          end
        raise NoPlugin, message
      end

      # The classes that the file defines and that are no base class of another one.
      def classes(file, base)
        own = Plugin.derived.select { |one, path| path == file && one < base }.map(&:first)
        own.reject { |one| own.any? { |other| other < one } }.sort_by(&:to_s)
      end

      # Removes the previous plug-in's classes and functions, which this one could reopen or
      # call.
      def forget_previous(file)
        forget_constants(@previous) if @previous
        forget_functions(@previous) if @previous
        Plugin.derived.clear
        @previous = file
      end

      def forget_constants(file)
        Object.constants.each do |name|
          next if Object.autoload?(name)

          place, = Object.const_source_location(name)
          Object.send(:remove_const, name) if place == file
        end
      end

      def forget_functions(file)
        Object.private_instance_methods(false).each do |name|
          place, = Object.instance_method(name).source_location
          Object.send(:remove_method, name) if place == file
        end
      end
    end
  end
end
