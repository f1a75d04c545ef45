--  SPDX-License-Identifier: Apache-2.0
--  Sends measurements, files and texts of a program to rtf. They belong to the case that
--  runs at that time. If rtf did not start the program, the functions only check limits.
--  They can be called from any task.

package RTF_Session is

   --  No limit.
   Lowest  : constant Long_Float := Long_Float'First;
   Highest : constant Long_Float := Long_Float'Last;

   --  Whether rtf runs this program.
   function Is_Open return Boolean;

   --  Whether this process was forked by the one that rtf runs. It can report measurements,
   --  files and texts, but no results.
   function Is_Forked return Boolean;

   --  Records a number, and returns whether it is within its limits. If it is not, the case
   --  fails and continues.
   function Measure
     (Name  : String;
      Value : Long_Float;
      Unit  : String     := "";
      Low   : Long_Float := Lowest;
      High  : Long_Float := Highest) return Boolean;

   --  The same for callers that ignore the result.
   procedure Measure
     (Name  : String;
      Value : Long_Float;
      Unit  : String     := "";
      Low   : Long_Float := Lowest;
      High  : Long_Float := Highest);

   --  Adds a copy of a file to the results. A file that is missing is an error of the case.
   procedure Attach (Path : String; Name : String := ""; Media_Type : String := "");

   --  Adds a text to the results.
   procedure Report (Text : String);

   --  For reporters: sends a packet of spec/frameworks.md. The answer is empty if rtf did
   --  not start the program.
   function Exchange (Method : String; Fields : String) return String;
   procedure Send (Method : String; Fields : String);

   --  For reporters: sends a message, several if the text is too long for one packet.
   --  More are further fields, each after a comma.
   procedure Send_Message (Kind : String; Text : String; More : String := "");

   --  For reporters: a JSON string. Bytes that are not UTF-8 are Latin-1.
   function Quoted (Text : String) return String;

end RTF_Session;
